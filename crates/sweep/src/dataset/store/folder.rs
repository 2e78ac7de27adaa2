//! A dataset in a folder: hard links make records that are created once; without hard links,
//! exclusive creation does.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use files::Locked;
use recordings::{FileRecord, WholeFile, sync_folder};
use sha2::{Digest, Sha256};

use super::holder::Holder;
use super::temporary::temporary;
use crate::Error;

/// The folder of a dataset.
#[derive(Debug)]
pub(in crate::dataset) struct Folder(PathBuf);

impl Folder {
    pub(super) fn new(root: &Path) -> Self {
        Self(root.to_owned())
    }

    /// The folder itself.
    pub(in crate::dataset) fn root(&self) -> &Path {
        &self.0
    }

    pub(super) fn path(&self, path: &str) -> PathBuf {
        self.0.join(path)
    }

    pub(super) fn create(&self, path: &str) -> Result<WholeFile, Error> {
        Ok(WholeFile::create(
            &self.path(&temporary(path)),
            &self.path(path),
        )?)
    }

    pub(super) fn create_only(&self, path: &str, content: &str) -> Result<Option<Vec<u8>>, Error> {
        let destination = self.path(path);
        if let Some(before) = self.bytes(path)? {
            return Ok(Some(before));
        }
        // Written whole under a name of its own, and then linked, which fails where a file stands.
        let staged = temporary(&format!("{path}.staged"));
        let mut file = self.create(&staged)?;
        let written = file.write_all(content.as_bytes());
        written.map_err(recordings::Error::Write)?;
        file.commit()?;
        let linked = fs::hard_link(self.path(&staged), &destination);
        self.remove(&staged)?;
        let created = match linked {
            Err(error) if error.kind() != ErrorKind::AlreadyExists => {
                create_exclusively(&destination, content)
            }
            linked => linked,
        };
        match created {
            // A link is on the disk once its folder is.
            Ok(()) => Ok(sync_folder(&destination).map(|()| None)?),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => self.bytes(path),
            Err(error) => Err(failed("create", &destination, error)),
        }
    }

    /// The lock is taken before the file has its name, so it is never visible without one. There
    /// is no lock if the file system has none.
    pub(super) fn hold(&self, path: &str, content: &str) -> Result<Option<Locked>, Error> {
        let (temporary, path) = (self.path(&temporary(path)), self.path(path));
        let mut file =
            File::create(&temporary).map_err(|error| failed("create", &temporary, error))?;
        let locked = file.try_lock().is_ok();
        let written = file.write_all(content.as_bytes());
        let lock = locked.then(|| Locked::new(file));
        let placed = written.and_then(|()| fs::rename(&temporary, &path));
        placed.map_err(|error| failed("write", &path, error))?;
        Ok(lock)
    }

    pub(super) fn holder(&self, path: &str) -> Result<Option<Holder>, Error> {
        let path = self.path(path);
        let file = if_exists("read", &path, File::open(&path))?;
        Ok(file.map(|file| match file.try_lock_shared() {
            Ok(()) => {
                drop(Locked::new(file));
                Holder::Ended
            }
            Err(TryLockError::WouldBlock) => Holder::AtWork,
            Err(TryLockError::Error(_)) => Holder::Unknown,
        }))
    }

    pub(super) fn modified(&self, path: &str) -> Result<Option<SystemTime>, Error> {
        let path = self.path(path);
        let modified = fs::metadata(&path).and_then(|found| found.modified());
        if_exists("read", &path, modified)
    }

    pub(super) fn bytes(&self, path: &str) -> Result<Option<Vec<u8>>, Error> {
        let path = self.path(path);
        if_exists("read", &path, fs::read(&path))
    }

    pub(super) fn length(&self, path: &str) -> Result<Option<u64>, Error> {
        let path = self.path(path);
        Ok(if_exists("read", &path, fs::metadata(&path))?.map(|found| found.len()))
    }

    pub(super) fn range(&self, path: &str, range: Range<u64>) -> Result<Vec<u8>, Error> {
        let path = self.path(path);
        let read = |mut file: File| {
            let mut bytes = vec![0; (range.end - range.start) as usize];
            file.seek(SeekFrom::Start(range.start))?;
            file.read_exact(&mut bytes)?;
            Ok(bytes)
        };
        let bytes = File::open(&path).and_then(read);
        bytes.map_err(|error| failed("read", &path, error))
    }

    pub(super) fn record(&self, path: &str) -> Result<Option<FileRecord>, Error> {
        let path = self.path(path);
        // Reading a pipe would wait, and a folder is no file.
        if fs::metadata(&path).is_ok_and(|found| !found.is_file()) {
            return Ok(None);
        }
        let Some(mut file) = if_exists("read", &path, File::open(&path))? else {
            return Ok(None);
        };
        let (mut hash, mut bytes, mut part) = (Sha256::new(), 0, vec![0; 1 << 16]);
        loop {
            match file.read(&mut part) {
                Ok(0) => break,
                Ok(count) => {
                    hash.update(&part[..count]);
                    bytes += count as u64;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(failed("read", &path, error)),
            }
        }
        let sha256 = format!("{:x}", hash.finalize());
        Ok(Some(FileRecord { bytes, sha256 }))
    }

    pub(super) fn names(&self, folder: &str) -> Result<Vec<String>, Error> {
        let folder = self.path(folder);
        let Some(entries) = if_exists("read", &folder, fs::read_dir(&folder))? else {
            return Ok(Vec::new());
        };
        let name = |entry: io::Result<fs::DirEntry>| {
            let entry = entry.map_err(|error| failed("read", &folder, error))?;
            Ok(entry.file_name().to_string_lossy().into_owned())
        };
        entries.map(name).collect()
    }

    pub(super) fn remove(&self, path: &str) -> Result<(), Error> {
        let path = self.path(path);
        if_exists("remove", &path, fs::remove_file(&path)).map(|_| ())
    }
}

/// Writes a file where none stands, on file systems without hard links (exFAT, some SMB). A crash may
/// leave it cut short, which readers of records take for none.
fn create_exclusively(path: &Path, content: &str) -> io::Result<()> {
    let mut file = File::create_new(path)?;
    file.write_all(content.as_bytes())?;
    file.sync_all()
}

/// The result of reading `path`; nothing if there is no file.
fn if_exists<T>(
    action: &'static str,
    path: &Path,
    result: io::Result<T>,
) -> Result<Option<T>, Error> {
    match result {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(failed(action, path, error)),
    }
}

/// The error of an action at a file.
pub(in crate::dataset) fn failed(action: &'static str, path: &Path, source: io::Error) -> Error {
    let path = path.to_owned();
    Error::File(recordings::Error::Io {
        action,
        path,
        source,
    })
}

/// Makes `folder`, and those that it stands in.
pub(in crate::dataset) fn make(folder: &Path) -> Result<(), Error> {
    fs::create_dir_all(folder).map_err(|source| Error::Unwritable {
        path: folder.to_owned(),
        source,
    })
}

/// Removes what stands at `path`, if something does.
pub(in crate::dataset) fn remove(
    path: &Path,
    how: impl Fn(&Path) -> io::Result<()>,
) -> Result<(), Error> {
    match how(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::Unwritable {
            path: path.to_owned(),
            source: error,
        }),
        _ => Ok(()),
    }
}
