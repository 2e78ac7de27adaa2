//! The calibration that a dataset begins with: its files, in the folder `calibration/`.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use recordings::{FileEntry, FileRecord};
use serde_json::Value;

use super::layout::CALIBRATION;
use super::output::Output;
use super::record::text;
use super::store::failed;
use crate::{Error, Plan};

/// What was copied to a bucket, which may list it late.
const COPIED: &str = "_sweep/calibration.json";

/// The files of a calibration as `crosshead calibrate` writes it that are always there.
const FILES: [&str; 2] = ["calibration.json", "machine.yaml"];
/// Those that are there where it has something to show: over the crank angle, by order, of the gas, and its page.
const PICTURES: [&str; 4] = [
    "waveforms.parquet",
    "orders.parquet",
    "indicator.parquet",
    "report.html",
];
/// Most bytes of such a file, 256 MiB: all are in memory before the first is written.
const LONGEST: u64 = 1 << 28;

/// The name of a file of a calibration, and what stands in it.
pub(super) type Kept = (&'static str, Vec<u8>);

/// The calibration in the folder `from`, whose files are no links; nothing where there is no such folder.
///
/// # Errors
/// A folder that is something else: what a sweep file names must not publish other files.
pub(super) fn read(from: &Path) -> Result<Vec<Kept>, Error> {
    let wrong = |reason: String| Error::NotACalibration {
        path: from.to_owned(),
        reason,
    };
    match from.symlink_metadata() {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(wrong(error.to_string())),
        Ok(found) if !found.is_dir() => return Err(wrong("it is a link or a file".into())),
        Ok(_) => {}
    }
    let mut kept = Vec::new();
    for name in FILES.into_iter().chain(PICTURES) {
        let content =
            files::open_itself(&from.join(name)).and_then(|file| files::content(file, LONGEST));
        match content {
            Ok(content) => kept.push((name, content)),
            Err(error) if error.kind() == ErrorKind::NotFound && PICTURES.contains(&name) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return Err(wrong(format!("it has no {name}")));
            }
            Err(error) => return Err(wrong(format!("{name}: {error}"))),
        }
    }
    let results: Option<Value> = serde_json::from_slice(&kept[0].1).ok();
    if !results.is_some_and(|results| results["parameters"].is_object()) {
        return Err(wrong(
            "its calibration.json has no section `parameters`".into(),
        ));
    }
    let machine = std::str::from_utf8(&kept[1].1)
        .map_err(|_| wrong("its machine.yaml is not text".into()))?;
    let place = from.join(FILES[1]).display().to_string();
    input::MachineFile::from_yaml(machine, &place).map_err(|error| wrong(error.to_string()))?;
    Ok(kept)
}

/// Checks that what `plan` names as the calibration that its dataset begins with is one.
///
/// # Errors
/// [`Error::NotACalibration`] for a folder that is something else.
pub fn check_calibration(plan: &Plan) -> Result<(), Error> {
    plan.calibrated
        .as_deref()
        .map_or(Ok(()), |from| read(from).map(drop))
}

impl Output {
    /// Writes the files of a calibration into the dataset; none is nothing to do.
    pub(super) fn keep_calibration(&self, kept: Vec<Kept>) -> Result<(), Error> {
        if kept.is_empty() {
            return Ok(());
        }
        if self.store.folder().is_some() {
            let folder = self.path(CALIBRATION);
            fs::create_dir_all(&folder).map_err(|source| failed("create", &folder, source))?;
        }
        let mut entries = Vec::new();
        for (name, content) in kept {
            let path = format!("{CALIBRATION}/{name}");
            let FileRecord { bytes, sha256 } = self.store.write(&path, &content)?;
            entries.push(FileEntry {
                path,
                bytes,
                sha256,
                rows: None,
            });
        }
        if self.store.folder().is_none() {
            self.store.create_only(COPIED, &text(&entries)?)?;
        }
        Ok(())
    }

    /// The files of the calibration as the manifest has them.
    pub(super) fn calibration_entries(&self) -> Result<Vec<FileEntry>, Error> {
        if let Some(copied) = self.store.read(COPIED)? {
            return serde_json::from_str(&copied).map_err(|error| Error::Damaged {
                path: self.path(COPIED),
                reason: error.to_string(),
            });
        }
        let mut entries = Vec::new();
        for name in FILES.into_iter().chain(PICTURES) {
            let path = format!("{CALIBRATION}/{name}");
            if let Some(FileRecord { bytes, sha256 }) = self.store.record(&path)? {
                entries.push(FileEntry {
                    path,
                    bytes,
                    sha256,
                    rows: None,
                });
            }
        }
        Ok(entries)
    }
}
