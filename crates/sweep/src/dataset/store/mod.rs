//! The storage of a dataset, with two guarantees for its commits: a file appears when it is
//! complete, and of several processes that create a record exactly one succeeds.

#[cfg(feature = "s3")]
mod bucket;
mod folder;
mod holder;
mod new_file;
mod temporary;

use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use files::Locked;
use recordings::FileRecord;

use crate::Error;
#[cfg(feature = "s3")]
use bucket::Bucket;
use folder::Folder;
pub(super) use folder::{failed, make, remove};
pub(super) use holder::Holder;
pub(super) use new_file::NewFile;
pub(super) use temporary::process;
use temporary::temporary;

/// Records that are read at a time: on storage that takes its time they would else take long.
pub(super) const READERS: usize = 16;

/// The place of a dataset. Paths in it have `/` between folders.
#[derive(Debug)]
pub(super) enum Store {
    /// A folder of a file system.
    Folder(Folder),
    /// A prefix of a bucket.
    #[cfg(feature = "s3")]
    Bucket(Bucket),
}

impl Store {
    /// The place that `root` names: a folder, or `s3://BUCKET/PREFIX`.
    pub(super) fn at(root: &Path) -> Result<Self, Error> {
        match root.to_str().and_then(|url| url.strip_prefix("s3://")) {
            None => Ok(Self::Folder(Folder::new(root))),
            Some(address)
                if address
                    .split('/')
                    .next()
                    .is_some_and(|host| host.contains('@')) =>
            {
                Err(Error::Password)
            }
            #[cfg(feature = "s3")]
            Some(address) => Ok(Self::Bucket(Bucket::new(root, address)?)),
            #[cfg(not(feature = "s3"))]
            Some(_) => Err(Error::NoObjectStorage(root.to_owned())),
        }
    }

    /// The folder that it is, if it is one.
    pub(super) fn folder(&self) -> Option<&Path> {
        match self {
            Self::Folder(store) => Some(store.root()),
            #[cfg(feature = "s3")]
            Self::Bucket(_) => None,
        }
    }

    /// Where `path` stands, for messages.
    pub(super) fn path(&self, path: &str) -> PathBuf {
        match self {
            Self::Folder(store) => store.path(path),
            #[cfg(feature = "s3")]
            Self::Bucket(store) => store.path(path),
        }
    }

    /// Starts a file that will stand at `path` when it is finished, in place of any other.
    pub(super) fn create(&self, path: &str) -> Result<NewFile, Error> {
        match self {
            Self::Folder(store) => Ok(NewFile::File(store.create(path)?)),
            #[cfg(feature = "s3")]
            Self::Bucket(store) => Ok(NewFile::Object(Box::new(store.create(path)))),
        }
    }

    /// Writes a file at once.
    pub(super) fn write(&self, path: &str, content: &[u8]) -> Result<FileRecord, Error> {
        let mut file = self.create(path)?;
        file.write_all(content).map_err(recordings::Error::Write)?;
        file.commit()
    }

    /// Writes `content` to `path` unless a file is there already, whose content is then returned.
    /// Of several processes that try at once one succeeds.
    pub(super) fn create_only(&self, path: &str, content: &str) -> Result<Option<Vec<u8>>, Error> {
        match self {
            Self::Folder(store) => store.create_only(path, content),
            #[cfg(feature = "s3")]
            Self::Bucket(store) => store.create_only(path, content),
        }
    }

    /// Puts a file of this process, locked until it ends where the place knows locks.
    pub(super) fn hold(&self, path: &str, content: &str) -> Result<Option<Locked>, Error> {
        match self {
            Self::Folder(store) => store.hold(path, content),
            #[cfg(feature = "s3")]
            Self::Bucket(_) => self.write(path, content.as_bytes()).map(|_| None),
        }
    }

    /// Who holds the file at `path`, if it stands there.
    pub(super) fn holder(&self, path: &str) -> Result<Option<Holder>, Error> {
        match self {
            Self::Folder(store) => store.holder(path),
            #[cfg(feature = "s3")]
            Self::Bucket(_) => Ok(Some(Holder::Unknown)),
        }
    }

    /// When the file at `path` was last written, by the clock of the place.
    pub(super) fn modified(&self, path: &str) -> Result<Option<SystemTime>, Error> {
        match self {
            Self::Folder(store) => store.modified(path),
            #[cfg(feature = "s3")]
            Self::Bucket(store) => store.modified(path),
        }
    }

    /// The time by the clock of the place, which no host's need agree with.
    pub(super) fn now(&self) -> Result<SystemTime, Error> {
        let path = temporary("clock");
        self.write(&path, b"")?;
        let now = self.modified(&path);
        self.remove(&path)?;
        Ok(now?.unwrap_or(SystemTime::UNIX_EPOCH))
    }

    /// What stands at `path`, if something does.
    pub(super) fn bytes(&self, path: &str) -> Result<Option<Vec<u8>>, Error> {
        match self {
            Self::Folder(store) => store.bytes(path),
            #[cfg(feature = "s3")]
            Self::Bucket(store) => store.bytes(path),
        }
    }

    /// The text at `path`, if something stands there.
    pub(super) fn read(&self, path: &str) -> Result<Option<String>, Error> {
        let text = self.bytes(path)?.map(String::from_utf8).transpose();
        text.map_err(|_| {
            let error = io::Error::new(io::ErrorKind::InvalidData, "it is not valid UTF-8");
            failed("read", &self.path(path), error)
        })
    }

    /// Some bytes of what stands at `path`, which must have them.
    pub(super) fn range(&self, path: &str, range: Range<u64>) -> Result<Vec<u8>, Error> {
        match self {
            Self::Folder(store) => store.range(path, range),
            #[cfg(feature = "s3")]
            Self::Bucket(store) => store.range(path, range),
        }
    }

    /// Length and checksum of what stands at `path`, if something does.
    pub(super) fn record(&self, path: &str) -> Result<Option<FileRecord>, Error> {
        match self {
            Self::Folder(store) => store.record(path),
            #[cfg(feature = "s3")]
            Self::Bucket(store) => store.record(path),
        }
    }

    /// Length in bytes of what stands at `path`, if something does.
    pub(super) fn length(&self, path: &str) -> Result<Option<u64>, Error> {
        match self {
            Self::Folder(store) => store.length(path),
            #[cfg(feature = "s3")]
            Self::Bucket(store) => store.length(path),
        }
    }

    /// The names of the files and folders in `folder`, in any order; none where there is no such folder.
    pub(super) fn names(&self, folder: &str) -> Result<Vec<String>, Error> {
        match self {
            Self::Folder(store) => store.names(folder),
            #[cfg(feature = "s3")]
            Self::Bucket(store) => store.names(folder),
        }
    }

    /// Removes the file at `path`, if there is one.
    pub(super) fn remove(&self, path: &str) -> Result<(), Error> {
        match self {
            Self::Folder(store) => store.remove(path),
            #[cfg(feature = "s3")]
            Self::Bucket(store) => store.remove(path),
        }
    }
}
