//! Where a dataset is kept, with the few things that its commits ask of such a place: a file
//! appears whole or not at all, and of several processes that create a record one succeeds.

mod folder;
mod temporary;

use std::io::Write;
use std::path::{Path, PathBuf};

use recordings::{FileRecord, WholeFile};

use crate::Error;
use folder::Folder;
pub(super) use temporary::process;

/// The place of a dataset. Paths in it have `/` between folders.
#[derive(Debug)]
pub(super) enum Store {
    /// A folder of a file system.
    Folder(Folder),
}

impl Store {
    /// The place that `root` names.
    pub(super) fn at(root: &Path) -> Result<Self, Error> {
        Ok(Self::Folder(Folder::new(root)))
    }

    /// Where `path` stands, for messages.
    pub(super) fn path(&self, path: &str) -> PathBuf {
        match self {
            Self::Folder(folder) => folder.path(path),
        }
    }

    /// Starts a file that will stand at `path` when it is finished, in place of any other.
    pub(super) fn create(&self, path: &str) -> Result<WholeFile, Error> {
        match self {
            Self::Folder(folder) => folder.create(path),
        }
    }

    /// Writes a file at once.
    pub(super) fn write(&self, path: &str, content: &[u8]) -> Result<FileRecord, Error> {
        let mut file = self.create(path)?;
        file.write_all(content).map_err(recordings::Error::Write)?;
        Ok(file.commit()?)
    }

    /// Writes `content` to `path` unless something stands there already, which is then handed back.
    /// Of several processes that try at once one succeeds.
    pub(super) fn create_only(&self, path: &str, content: &str) -> Result<Option<String>, Error> {
        match self {
            Self::Folder(folder) => folder.create_only(path, content),
        }
    }

    /// The text at `path`, if something stands there.
    pub(super) fn read(&self, path: &str) -> Result<Option<String>, Error> {
        match self {
            Self::Folder(folder) => folder.read(path),
        }
    }

    /// Length and checksum of what stands at `path`, if something does.
    pub(super) fn record(&self, path: &str) -> Result<Option<FileRecord>, Error> {
        match self {
            Self::Folder(folder) => folder.record(path),
        }
    }

    /// Length in bytes of what stands at `path`, if something does.
    pub(super) fn length(&self, path: &str) -> Result<Option<u64>, Error> {
        match self {
            Self::Folder(folder) => folder.length(path),
        }
    }

    /// The names of the files in `folder`, in any order; none where there is no such folder.
    pub(super) fn names(&self, folder: &str) -> Result<Vec<String>, Error> {
        match self {
            Self::Folder(root) => root.names(folder),
        }
    }

    /// Removes the file at `path`, if there is one.
    pub(super) fn remove(&self, path: &str) -> Result<(), Error> {
        match self {
            Self::Folder(folder) => folder.remove(path),
        }
    }
}
