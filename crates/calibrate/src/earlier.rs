//! Results of a search that are in the folder already.

use crate::checkpoint::Checkpoint;
use crate::error::Error;
use crate::results::MACHINE;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::Path;

/// Name of the file of what was evaluated, which is there while a search is not complete.
const CHECKPOINT: &str = "checkpoint.bin";

/// What becomes of results that are there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// They are left alone, and that is an error.
    Refuse,
    /// They are kept where they are complete, and the search goes on where they are not. Those of other recordings,
    /// another machine or other settings are an error.
    Resume,
    /// The same, but what was made from something else is made anew.
    Renew,
    /// They are made anew.
    Overwrite,
}

/// What a search into a folder comes to.
pub(crate) trait Outcome: DeserializeOwned {
    /// Name of its file.
    const FILE: &str;
    /// What it is, with its article.
    const NAME: &str;

    /// The digest of its inputs.
    fn fingerprint(&self) -> &str;

    /// Whether the search went to its end.
    fn is_complete(&self) -> bool;
}

/// Checks that the folder may be written into, before any work. One that is renewed is known to be
/// ours.
///
/// # Errors
/// Results that are not to be touched, or a folder with something else in it.
pub(crate) fn check_folder<R: Outcome>(folder: &Path, existing: Existing) -> Result<(), Error> {
    if existing == Existing::Renew {
        return Ok(());
    }
    if folder.join(R::FILE).is_file() {
        return match existing {
            Existing::Refuse => Err(Error::Refused(format!(
                "{} holds {} already: --resume goes on with it, --overwrite replaces it, \
                 --out DIR writes elsewhere",
                folder.display(),
                R::NAME
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
            "{} holds {} that was interrupted: --resume goes on with it, --overwrite begins anew, \
             --out DIR writes elsewhere",
            folder.display(),
            R::NAME
        ))),
        true => Ok(()),
        false => Err(Error::Refused(format!(
            "{} is not empty and not {}, so it is left alone: choose another folder",
            folder.display(),
            R::NAME
        ))),
    }
}

/// The results in `folder`, if they are of these inputs and to be gone on with.
///
/// # Errors
/// Those of other inputs that are to be resumed, or a file that cannot be read.
pub(crate) fn read_existing<R: Outcome>(
    folder: &Path,
    existing: Existing,
    fingerprint: &str,
) -> Result<Option<R>, Error> {
    let checkpoint = folder.join(CHECKPOINT);
    let path = folder.join(R::FILE);
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
    let results = serde_json::from_value::<R>(content).ok();
    let same = results.filter(|r| r.fingerprint() == fingerprint && folder.join(MACHINE).is_file());
    match (same, existing) {
        (Some(results), _) => Ok(Some(results)),
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

/// The checkpoint of a search into `folder`: what was evaluated before, if it goes on, or nothing yet.
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

/// Takes the checkpoint of a search away that is complete.
///
/// # Errors
/// A file that cannot be removed.
pub(crate) fn remove_checkpoint(folder: &Path) -> Result<(), Error> {
    let path = folder.join(CHECKPOINT);
    std::fs::remove_file(&path).map_err(|error| Error::file(&path, error))
}
