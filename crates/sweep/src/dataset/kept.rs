//! The calibration that a dataset begins with: its files, in the folder `calibration/`.

use std::fs;
use std::path::Path;

use recordings::{FileEntry, FileRecord};

use super::commit::text;
use super::output::{CALIBRATION, Output};
use super::store::failed;
use crate::Error;

/// What was copied to a bucket, which may list it late.
const COPIED: &str = "_sweep/calibration.json";

impl Output {
    /// Copies the calibration in the folder `from`; nothing where there is none.
    pub(super) fn copy_calibration(&self, from: &Path) -> Result<(), Error> {
        if !from.is_dir() {
            return Ok(());
        }
        let mut entries = Vec::new();
        for name in names(from, "")? {
            let content = read(&from.join(&name))?;
            let path = format!("{CALIBRATION}/{name}");
            if self.store.folder().is_some()
                && let Some(folder) = self.path(&path).parent()
            {
                fs::create_dir_all(folder).map_err(|source| failed("create", folder, source))?;
            }
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
        let mut folders = vec![CALIBRATION.to_owned()];
        while let Some(folder) = folders.pop() {
            for name in self.store.names(&folder)? {
                let path = format!("{folder}/{name}");
                match self.store.record(&path)? {
                    None => folders.push(path),
                    Some(FileRecord { bytes, sha256 }) => entries.push(FileEntry {
                        path,
                        bytes,
                        sha256,
                        rows: None,
                    }),
                }
            }
        }
        Ok(entries)
    }
}

/// Every file below `folder`, as a path from there that begins with `prefix`.
fn names(folder: &Path, prefix: &str) -> Result<Vec<String>, Error> {
    let unreadable = |source| failed("read", folder, source);
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            names.extend(self::names(&entry.path(), &format!("{name}/"))?);
        } else {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

fn read(path: &Path) -> Result<Vec<u8>, Error> {
    fs::read(path).map_err(|source| failed("read", path, source))
}
