//! A calibration that is in the folder already.

use super::{Existing, output};
use crate::Failure;
use ::calibrate::Problem;
use serde_json::Value;
use std::path::Path;

/// What an earlier calibration of the same inputs has left.
pub struct Earlier {
    /// The content of its `calibration.json`.
    pub results: Value,
}

impl Earlier {
    /// Whether it went to its end.
    pub fn is_complete(&self) -> bool {
        self.results["complete"] == true
    }

    /// Its evaluations of the model, and their time, s.
    pub fn spent(&self) -> (u64, f64) {
        let evaluations = self.results["evaluations"].as_u64();
        let seconds = self.results["seconds"].as_f64();
        (evaluations.unwrap_or(0), seconds.unwrap_or(0.0))
    }

    /// The coordinates of what it found, nominal where it found nothing.
    pub fn start(&self, problem: &Problem) -> Vec<f64> {
        let value = |path: &str| self.results["parameters"][path]["value"].as_f64();
        let parameters = problem.parameters.iter();
        parameters
            .map(|p| value(&p.path).map_or(0.0, |value| p.coordinate(value)))
            .collect()
    }
}

/// Checks that the folder may be written into, before any work. One that is renewed is known to be
/// ours.
///
/// # Errors
/// A calibration that is not to be touched, or a folder with something else in it.
pub fn check_folder(folder: &Path, existing: Existing) -> Result<(), Failure> {
    if existing == Existing::Renew {
        return Ok(());
    }
    if folder.join(output::RESULTS).is_file() {
        return match existing {
            Existing::Refuse => Err(Failure::input(format!(
                "{} holds a calibration already: --resume goes on with it, --overwrite replaces it, \
                 --out DIR writes elsewhere",
                folder.display()
            ))),
            _ => Ok(()),
        };
    }
    let mut entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(Failure::input(format!("{}: {error}", folder.display()))),
    };
    match entries.next() {
        None => Ok(()),
        Some(_) => Err(Failure::input(format!(
            "{} is not empty and no calibration, so it is left alone: choose another folder",
            folder.display()
        ))),
    }
}

/// The calibration in `folder`, if it is of these inputs and to be gone on with.
///
/// # Errors
/// One of other inputs that is to be resumed, or a file that cannot be read.
pub fn look(
    folder: &Path,
    existing: Existing,
    fingerprint: &str,
) -> Result<Option<Earlier>, Failure> {
    let path = folder.join(output::RESULTS);
    if !path.is_file() || !matches!(existing, Existing::Resume | Existing::Renew) {
        return Ok(None);
    }
    let wrong = |reason: String| Failure::input(format!("{}: {reason}", path.display()));
    let text = std::fs::read_to_string(&path).map_err(|error| wrong(error.to_string()))?;
    let results: Value = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    let same = results["fingerprint"] == fingerprint && folder.join(output::MACHINE).is_file();
    match (same, existing) {
        (true, _) => Ok(Some(Earlier { results })),
        (false, Existing::Resume) => Err(wrong(
            "it was made from other recordings, another machine, other settings or by another \
             version: --overwrite makes it anew, --out DIR writes elsewhere"
                .into(),
        )),
        (false, _) => Ok(None),
    }
}
