//! Records of a dataset as JSON, and their checksums.

use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::Error;

/// A record as it is written.
pub(super) fn text(record: &impl Serialize) -> Result<String, Error> {
    Ok(serde_json::to_string_pretty(record).map_err(unwritable)? + "\n")
}

/// A record on one line, without the line's end.
pub(super) fn line(record: &impl Serialize) -> Result<String, Error> {
    Ok(serde_json::to_string(record).map_err(unwritable)?)
}

fn unwritable(error: serde_json::Error) -> recordings::Error {
    recordings::Error::Write(std::io::Error::other(error.to_string()))
}

/// SHA-256 of a text, in hexadecimal.
pub(super) fn checksum(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
