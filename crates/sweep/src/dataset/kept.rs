//! The calibration that a dataset begins with: its files, in the folder `calibration/`.

use std::fs;
use std::io;
use std::path::Path;

use recordings::FileEntry;
use sha2::{Digest, Sha256};

use super::output::{CALIBRATION, Output};
use crate::Error;

impl Output {
    /// Copies the calibration in the folder `from`; nothing where there is none.
    pub(super) fn copy_calibration(&self, from: &Path) -> Result<(), Error> {
        if !from.is_dir() {
            return Ok(());
        }
        for name in names(from, "")? {
            let content = read(&from.join(&name))?;
            let path = format!("{CALIBRATION}/{name}");
            if let Some(folder) = self.path(&path).parent() {
                fs::create_dir_all(folder).map_err(|source| failed("create", folder, source))?;
            }
            self.store.write(&path, &content)?;
        }
        Ok(())
    }

    /// The files of the calibration as the manifest has them.
    pub(super) fn calibration_entries(&self) -> Result<Vec<FileEntry>, Error> {
        let folder = self.path(CALIBRATION);
        if !folder.is_dir() {
            return Ok(Vec::new());
        }
        let entry = |name: String| {
            let content = read(&folder.join(&name))?;
            let digest = Sha256::digest(&content);
            Ok(FileEntry {
                path: format!("{CALIBRATION}/{name}"),
                bytes: content.len() as u64,
                sha256: digest.iter().map(|byte| format!("{byte:02x}")).collect(),
                rows: None,
            })
        };
        names(&folder, "")?.into_iter().map(entry).collect()
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

fn failed(action: &'static str, path: &Path, source: io::Error) -> Error {
    let path = path.to_owned();
    Error::File(recordings::Error::Io {
        action,
        path,
        source,
    })
}
