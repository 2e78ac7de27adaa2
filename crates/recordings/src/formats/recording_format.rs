//! What a format of recordings says of itself, so that a file is opened by its reader.

use crate::Error;
use crate::measured::{MeasuredFile, Options};
use std::path::Path;

/// A format of recordings.
pub(crate) struct RecordingFormat {
    /// Its name.
    pub name: &'static str,
    /// Endings of the names of its files, in lower case.
    pub endings: &'static [&'static str],
    /// Where in a file its signature begins, bytes; none for text, which has no signature.
    pub signature_at: Option<usize>,
    /// What the first bytes of a file are in words, where they are of this format.
    pub recognise: fn(&[u8]) -> Option<&'static str>,
    /// Opens a file and reads its heading.
    pub open: fn(&Path, &Options) -> Result<MeasuredFile, Error>,
}

/// Whether `signature` stands at byte `at` of the first bytes of a file.
pub(crate) fn has(head: &[u8], at: usize, signature: &[u8]) -> bool {
    head.get(at..at + signature.len()) == Some(signature)
}
