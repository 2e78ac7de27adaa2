//! How much a file may become when it is decoded.
//!
//! A file of a few hundred bytes can say that it holds a number a thousand million times: run lengths, dictionaries and
//! compression know no limit. Recordings do: their noise does not compress. What a file decodes to is therefore compared
//! with its length. This happens before memory is taken where the file says how much it holds, and on the way elsewhere.

use std::fs;
use std::path::Path;

/// Bytes that any file may decode to: 512 MiB, which is 67 million numbers of eight bytes.
pub(crate) const ALWAYS: u64 = 1 << 29;

/// Bytes that a byte of a longer file may decode to. Readers hold eight bytes for each number, so that this is four
/// numbers in a byte. Text of one digit and a separator has half a number in one, a bit per sample would be eight.
const PER_BYTE: u64 = 32;

/// The most bytes that a file of `length` bytes may decode to.
pub(crate) fn most_of(length: u64) -> u64 {
    length.saturating_mul(PER_BYTE).max(ALWAYS)
}

/// Bytes that a file may still decode to.
pub(crate) struct Expansion {
    most: u64,
    left: u64,
}

impl Expansion {
    /// Nothing yet of the file at `path`.
    pub(crate) fn new(path: &Path) -> Self {
        // The reader of the format reports a file that cannot be looked at.
        let most = most_of(fs::metadata(path).map_or(0, |found| found.len()));
        Self { most, left: most }
    }

    /// Takes so many numbers; else what is wrong.
    pub(crate) fn take(&mut self, numbers: usize) -> Result<(), String> {
        let left = self.left.checked_sub(8 * numbers as u64);
        self.left = left.ok_or_else(|| exceeded(self.most))?;
        Ok(())
    }
}

/// What is said of a file that decodes to more than `most` bytes.
pub(crate) fn exceeded(most: u64) -> String {
    format!(
        "it decodes to more than {most} bytes, the most that recordings in a file of this length take ({PER_BYTE} for \
         each byte of the file, or {ALWAYS}): it is damaged, or made to exhaust memory"
    )
}
