//! What was found already, kept in a file: an explanation that was stopped goes on from there.
//!
//! Each line holds the key of a piece of work and its result. The key is a digest of everything that
//! the result depends on, recordings and version included, so that a line is never taken for another.

use crate::error::Error;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::{Debug, Write as _};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Results of finished work. Copies share them.
#[derive(Clone, Debug, Default)]
pub struct Journal(Option<Arc<Mutex<Kept>>>);

#[derive(Debug)]
struct Kept {
    known: BTreeMap<String, Vec<f64>>,
    file: File,
}

#[derive(Serialize, Deserialize)]
struct Line {
    key: String,
    numbers: Vec<f64>,
}

impl Journal {
    /// The journal in a file, which is made where there is none. A last line that was cut off does
    /// not count.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let failed = |source| Error::Journal {
            path: path.to_owned(),
            source,
        };
        let text = match path.exists() {
            true => std::fs::read_to_string(path).map_err(failed)?,
            false => String::new(),
        };
        let lines = text.lines().filter_map(|l| serde_json::from_str(l).ok());
        let known = lines.map(|line: Line| (line.key, line.numbers)).collect();
        let mut options = OpenOptions::new();
        let mut file = options
            .create(true)
            .append(true)
            .open(path)
            .map_err(failed)?;
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n").map_err(failed)?;
        }
        Ok(Self(Some(Arc::new(Mutex::new(Kept { known, file })))))
    }

    /// The numbers that `work` gives, or gave before for the same `input`.
    ///
    /// # Errors
    /// Those of `work`. A line that cannot be written is lost, and no more than that.
    pub(crate) fn once(
        &self,
        input: &dyn Debug,
        work: impl FnOnce() -> Result<Vec<f64>, Error>,
    ) -> Result<Vec<f64>, Error> {
        let Some(kept) = &self.0 else {
            return work();
        };
        let key = key(input);
        let open = || kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(numbers) = open().known.get(&key) {
            return Ok(numbers.clone());
        }
        let numbers = work()?;
        let line = Line { key, numbers };
        if let Ok(mut text) = serde_json::to_string(&line) {
            text.push('\n');
            let _lost = open().file.write_all(text.as_bytes());
        }
        Ok(line.numbers)
    }
}

/// Digest of an input as it shows itself: numbers are shown with all of their digits.
fn key(input: &dyn Debug) -> String {
    let mut text = env!("CARGO_PKG_VERSION").to_owned();
    let digest = match write!(text, "{input:?}") {
        Ok(()) => Sha256::digest(text.as_bytes()),
        Err(_) => Sha256::digest([]),
    };
    digest.iter().fold(String::new(), |mut hex, byte| {
        let _infallible = write!(hex, "{byte:02x}");
        hex
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_found_is_found_again_and_nothing_else() {
        let path = std::env::temp_dir().join(format!("journal-{}", std::process::id()));
        let third = 1.0 / 3.0;
        let found = Journal::open(&path)
            .unwrap()
            .once(&("a", third), || Ok(vec![third]));
        assert_eq!(found.unwrap(), [third]);
        // Cut off in the middle of a line.
        let mut file = OpenOptions::new().append(true).open(&path).unwrap();
        file.write_all(b"{\"key\": \"0").unwrap();
        let again = Journal::open(&path).unwrap();
        let known = again.once(&("a", third), || Ok(Vec::new())).unwrap();
        assert_eq!(known, [third]);
        let other = again.once(&("a", 0.333), || Ok(vec![2.0])).unwrap();
        assert_eq!(other, [2.0]);
        let known = Journal::open(&path)
            .unwrap()
            .once(&("a", 0.333), || Ok(Vec::new()));
        assert_eq!(known.unwrap(), [2.0]);
        std::fs::remove_file(path).unwrap();
    }
}
