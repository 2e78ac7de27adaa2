//! A calibration that is in the folder already.

use crate::checkpoint::Checkpoint;
use crate::error::Error;
use crate::results::{MACHINE, RESULTS, Results};
use serde_json::Value;
use std::path::Path;

/// Name of the file of what was evaluated, which is there while a calibration is not complete.
const CHECKPOINT: &str = "checkpoint.bin";

/// What becomes of a calibration that is there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// It is left alone, and that is an error.
    Refuse,
    /// It is kept where it is complete, and continued where it is not. One of other recordings,
    /// another machine or other settings is an error.
    Resume,
    /// The same, but one that was made from something else is made anew.
    Renew,
    /// It is made anew.
    Overwrite,
}

/// What an earlier calibration of the same inputs has left.
pub(crate) struct Earlier {
    /// The content of its `calibration.json`.
    pub results: Results,
}

impl Earlier {
    /// Whether it went to its end.
    pub fn is_complete(&self) -> bool {
        self.results.complete
    }
}

/// Checks that the folder may be written into, before any work. One that is renewed is known to be
/// ours.
///
/// # Errors
/// A calibration that is not to be touched, or a folder with something else in it.
pub(crate) fn check_folder(folder: &Path, existing: Existing) -> Result<(), Error> {
    if existing == Existing::Renew {
        return Ok(());
    }
    if folder.join(RESULTS).is_file() {
        return match existing {
            Existing::Refuse => Err(Error::Refused(format!(
                "{} holds a calibration already: --resume goes on with it, --overwrite replaces it, \
                 --out DIR writes elsewhere",
                folder.display()
            ))),
            _ => Ok(()),
        };
    }
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(Error::file(folder, error)),
    };
    let names = entries
        .filter_map(Result::ok)
        .map(|entry| entry.file_name());
    let names: Vec<_> = names.collect();
    match names.iter().any(|name| name == CHECKPOINT) {
        _ if names.is_empty() => Ok(()),
        true if existing == Existing::Refuse => Err(Error::Refused(format!(
            "{} holds a calibration that was interrupted: --resume goes on with it, --overwrite begins anew, \
             --out DIR writes elsewhere",
            folder.display()
        ))),
        true => Ok(()),
        false => Err(Error::Refused(format!(
            "{} is not empty and no calibration, so it is left alone: choose another folder",
            folder.display()
        ))),
    }
}

/// The calibration in `folder`, if it is of these inputs and to be gone on with.
///
/// # Errors
/// One of other inputs that is to be resumed, or a file that cannot be read.
pub(crate) fn read_existing(
    folder: &Path,
    existing: Existing,
    fingerprint: &str,
) -> Result<Option<Earlier>, Error> {
    let checkpoint = folder.join(CHECKPOINT);
    let path = folder.join(RESULTS);
    if existing == Existing::Resume && !path.is_file() && checkpoint.is_file() {
        return match Checkpoint::is_of(&checkpoint, fingerprint) {
            true => Ok(None),
            false => Err(other(&checkpoint)),
        };
    }
    if !path.is_file() || !matches!(existing, Existing::Resume | Existing::Renew) {
        return Ok(None);
    }
    let wrong = |reason: String| Error::file(&path, reason);
    let text =
        files::read_text(&path, files::LONGEST_TEXT).map_err(|error| wrong(error.to_string()))?;
    let content: Value = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    // Results of another version may have another form: they are of something else.
    let results = serde_json::from_value::<Results>(content).ok();
    let same = results.filter(|r| r.fingerprint == fingerprint && folder.join(MACHINE).is_file());
    match (same, existing) {
        (Some(results), _) => Ok(Some(Earlier { results })),
        (None, Existing::Resume) => Err(other(&path)),
        (None, _) => Ok(None),
    }
}

fn other(path: &Path) -> Error {
    Error::Refused(format!(
        "{}: it was made from other recordings, another machine, other settings or by another version: --overwrite \
         makes it anew, --out DIR writes elsewhere",
        path.display()
    ))
}

/// The checkpoint of a calibration into `folder`: what was evaluated before, if it goes on, or nothing yet.
///
/// # Errors
/// A file that cannot be written, or that another process is at work with.
pub(crate) fn checkpoint(
    folder: &Path,
    existing: Existing,
    fingerprint: &str,
) -> Result<Checkpoint, Error> {
    let path = folder.join(CHECKPOINT);
    let unwritten = |error| Error::file(&path, error);
    std::fs::create_dir_all(folder).map_err(unwritten)?;
    let anew = !matches!(existing, Existing::Resume | Existing::Renew);
    Checkpoint::open(&path, fingerprint, anew).map_err(unwritten)
}

/// Takes the checkpoint of a calibration away that is complete.
///
/// # Errors
/// A file that cannot be removed.
pub(crate) fn remove_checkpoint(folder: &Path) -> Result<(), Error> {
    let path = folder.join(CHECKPOINT);
    std::fs::remove_file(&path).map_err(|error| Error::file(&path, error))
}
