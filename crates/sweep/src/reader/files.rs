//! The files of a dataset.

use super::error::Error;
use super::subset::Subset;
use crate::dataset::damage;
use recordings::formats::parquet::ParquetFile;
use recordings::{Manifest, Table};
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The folder of a dataset and the files that its manifest lists.
pub(super) struct Files {
    folder: PathBuf,
    pub(super) manifest: Manifest,
    /// Tables that were compared with their checksums.
    compared: Mutex<BTreeSet<String>>,
}

impl Files {
    /// # Errors
    /// A folder without a manifest, or a manifest that cannot be read.
    pub(super) fn in_folder(folder: &Path) -> Result<Self, Error> {
        let manifest = folder.join("manifest.json");
        if !manifest.is_file() {
            return Err(no_manifest(folder));
        }
        Ok(Self {
            folder: folder.to_owned(),
            manifest: Manifest::read(&manifest).map_err(Error::File)?,
            compared: Mutex::default(),
        })
    }

    /// Where a file of the manifest is.
    pub(super) fn place(&self, path: &str) -> PathBuf {
        self.folder.join(path)
    }

    /// The files of a subset, from the dataset's folder.
    pub(super) fn paths(&self, subset: Subset) -> Vec<String> {
        let prefix = format!("{}/", subset.name());
        let listed = self.manifest.files.iter().map(|file| &file.path);
        listed
            .filter(|path| path.starts_with(&prefix) && path.ends_with(".parquet"))
            .cloned()
            .collect()
    }

    /// Opens a table that the manifest lists; the first time it is compared with its checksum.
    ///
    /// # Errors
    /// A file that is not there, or is not the one that was written.
    pub(super) fn open(&self, path: &str) -> Result<ParquetFile, Error> {
        let listed = self.manifest.files.iter().find(|file| file.path == path);
        let mut compared = self.compared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(entry) = listed
            && compared.insert(path.to_owned())
            && let Some(damage) = damage(&self.folder, entry).map_err(Box::new)?
        {
            let path = self.place(path);
            return Err(Error::Damaged { path, damage });
        }
        ParquetFile::open(&self.place(path)).map_err(Error::File)
    }

    /// What `of_table` makes of columns and rows of the table `path`, which is `file`.
    ///
    /// # Errors
    /// A table that lacks a column, or has one of another type.
    pub(super) fn read<T>(
        &self,
        path: &str,
        file: &ParquetFile,
        columns: &[&str],
        rows: Range<usize>,
        of_table: impl FnOnce(&Table) -> Result<T, recordings::Error>,
    ) -> Result<T, Error> {
        file.read(columns, rows)
            .and_then(|table| of_table(&table))
            .map_err(|error| Error::of_table(self.place(path), error))
    }
}

/// What is wrong with a folder that has no manifest.
fn no_manifest(folder: &Path) -> Error {
    let path = folder.to_owned();
    if !folder.is_dir() {
        Error::NoFolder(path)
    } else if folder.join("_sweep").is_dir() {
        Error::NotFinished(path)
    } else {
        Error::NoDataset(path)
    }
}
