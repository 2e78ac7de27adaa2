//! The calibration that a dataset begins with, kept beside it.
//!
//! Its files are in `calibration/`, as `crosshead calibrate` writes them. `_sweep/calibration.json`
//! is written last: what the calibration follows from, its files, and what the sweep makes of it.
//! The manifest does not have these files, because they say how long the search took, and because
//! the resolved sweep gives the same dataset without them.

use std::fs;
use std::path::{Path, PathBuf};

use recordings::FileEntry;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::commit::text;
use super::output::{Claim, make};
use crate::{Calibration, Error};

/// The folder of the calibration's files.
pub const FOLDER: &str = "calibration";
/// What says that the calibration is finished.
pub(super) const RECORD: &str = "_sweep/calibration.json";

/// Content of `_sweep/calibration.json`.
#[derive(Serialize, Deserialize)]
struct Record {
    /// What the calibration follows from.
    fingerprint: String,
    /// Its files.
    files: Vec<FileEntry>,
    /// What was found.
    calibration: Calibration,
}

/// The calibration that is kept in the dataset's folder `root`, if it follows from what
/// `fingerprint` stands for and its files are there in full length.
pub fn kept_calibration(root: &Path, fingerprint: &str) -> Option<Calibration> {
    let text = fs::read_to_string(root.join(RECORD)).ok()?;
    // A record that cannot be read is one of another version: the calibration is made again.
    let record: Record = serde_json::from_str(&text).ok()?;
    let is_whole = |file: &FileEntry| {
        let found = fs::metadata(root.join(&file.path));
        found.is_ok_and(|found| found.len() == file.bytes)
    };
    let same = record.fingerprint == fingerprint && record.files.iter().all(is_whole);
    same.then_some(record.calibration)
}

impl Claim {
    /// The calibration that is kept here; as [`kept_calibration`].
    pub fn kept_calibration(&mut self, fingerprint: &str) -> Option<Calibration> {
        let found = kept_calibration(self.output().root(), fingerprint);
        self.calibrated = found.is_some();
        found
    }

    /// The folder for the files of a calibration that is not kept yet. What an interrupted
    /// calibration left is in it.
    ///
    /// # Errors
    /// Where a dataset was begun with another calibration, or the folder cannot be written to.
    pub fn calibration_folder(&self) -> Result<PathBuf, Error> {
        self.make_room()?;
        let folder = self.output().path(FOLDER);
        make(&folder)?;
        Ok(folder)
    }

    /// Keeps a finished calibration, whose files are there, and hands back what was kept of it.
    ///
    /// # Errors
    /// Where its files cannot be read or the record cannot be written.
    pub fn keep_calibration(
        &mut self,
        fingerprint: &str,
        calibration: Calibration,
    ) -> Result<Calibration, Error> {
        let record = Record {
            fingerprint: fingerprint.to_owned(),
            files: files(self.output().root())?,
            calibration,
        };
        self.output().write(RECORD, text(&record)?.as_bytes())?;
        // As it will be read another time, to the last bit of every number.
        Ok(self
            .kept_calibration(fingerprint)
            .unwrap_or(record.calibration))
    }
}

/// The files of the calibration, by name.
fn files(root: &Path) -> Result<Vec<FileEntry>, Error> {
    let mut files = Vec::new();
    let io = |path: &Path| {
        let path = path.to_owned();
        move |source| Error::Unreadable { path, source }
    };
    let folder = root.join(FOLDER);
    for entry in fs::read_dir(&folder).map_err(io(&folder))? {
        let path = entry.map_err(io(&folder))?.path();
        if !path.is_file() {
            continue;
        }
        let content = fs::read(&path).map_err(io(&path))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let digest = Sha256::digest(&content);
        files.push(FileEntry {
            path: format!("{FOLDER}/{name}"),
            bytes: content.len() as u64,
            sha256: digest.iter().map(|byte| format!("{byte:02x}")).collect(),
            rows: None,
        });
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(files)
}
