//! Opens the files that people and strangers hand in.
//!
//! A path of a shared folder may lead to a pipe, which nobody ever writes to, or to a device, which
//! never ends. Only regular files are opened here, and every reader of the workspace opens its
//! files here. This includes pipes that a user gives on purpose (`/dev/stdin`, `<(...)`). Formats
//! with an index at the end, and formats that are read twice, cannot be read from a pipe. One rule
//! for all formats is easier to remember.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Error, ErrorKind, Read};
use std::ops::{Deref, DerefMut};
use std::path::Path;

/// Longest text of a person or of one result, in bytes: 64 MiB. The YAML reader takes no more text than that either.
pub const LONGEST_TEXT: u64 = 1 << 26;

/// Opens a regular file to read.
///
/// # Errors
/// Where it is not there, cannot be opened, or is a folder, a pipe, a device or a socket.
pub fn open(path: &Path) -> io::Result<File> {
    regular(without_waiting(0).read(true), path)
}

/// Opens a regular file to read that is no link to one.
///
/// # Errors
/// As [`open`], and where it is a link.
pub fn open_itself(path: &Path) -> io::Result<File> {
    if path.symlink_metadata()?.is_symlink() {
        let reason = "it is a link; expected a regular file";
        return Err(Error::new(ErrorKind::InvalidInput, reason));
    }
    regular(without_waiting(NO_LINK).read(true), path)
}

fn regular(options: &OpenOptions, path: &Path) -> io::Result<File> {
    let file = options.open(path).map_err(in_words)?;
    let kind = file.metadata()?.file_type();
    if kind.is_file() {
        return Ok(file);
    }
    Err(match kind.is_dir() {
        true => in_words(ErrorKind::IsADirectory.into()),
        false => Error::new(
            ErrorKind::InvalidInput,
            "it is a pipe, a device or a socket; expected a regular file",
        ),
    })
}

/// What commonly keeps a file from being opened, without the number that the system has for it.
fn in_words(error: Error) -> Error {
    let words = match error.kind() {
        ErrorKind::NotFound => "there is no such file",
        ErrorKind::IsADirectory => "it is a directory",
        ErrorKind::PermissionDenied => "permission denied",
        _ => return error,
    };
    Error::new(error.kind(), words)
}

/// The text of a regular file of at most `most` bytes.
///
/// # Errors
/// As [`open`]; a longer file, or one that is not UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    let text = content(open(path)?, most)?;
    let not_text = |_| Error::new(ErrorKind::InvalidData, "it is not text in UTF-8");
    String::from_utf8(text).map_err(not_text)
}

/// The content of `file`, of at most `most` bytes.
///
/// # Errors
/// A longer file, or one that cannot be read.
pub fn content(file: File, most: u64) -> io::Result<Vec<u8>> {
    let mut content = Vec::new();
    file.take(most + 1).read_to_end(&mut content)?;
    if content.len() as u64 > most {
        let reason = format!("it has more than {most} bytes, the most that is read of such a file");
        return Err(Error::new(ErrorKind::FileTooLarge, reason));
    }
    Ok(content)
}

/// A locked file. The lock is released when this is dropped, also where a process that another thread
/// has just started still has the file open.
#[derive(Debug)]
pub struct Locked(File);

impl Locked {
    /// A file on which this process has taken a lock.
    pub fn new(file: File) -> Self {
        Self(file)
    }
}

impl Deref for Locked {
    type Target = File;

    fn deref(&self) -> &File {
        &self.0
    }
}

impl DerefMut for Locked {
    fn deref_mut(&mut self) -> &mut File {
        &mut self.0
    }
}

impl Drop for Locked {
    fn drop(&mut self) {
        let _without_locks = self.0.unlock();
    }
}

/// Opens or makes a file that is read and written during long work, and locks it.
/// It is not locked if the file system has no locks.
///
/// # Errors
/// [`ErrorKind::ResourceBusy`] where another process holds it, or has just removed it; a file that cannot be opened.
pub fn lock(path: &Path) -> io::Result<Locked> {
    let busy = || {
        let reason = "another process is at work in this folder";
        Error::new(ErrorKind::ResourceBusy, reason)
    };
    let mut options = without_waiting(0);
    let options = options.read(true).write(true).create(true).truncate(false);
    let file = regular(options, path)?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => return Err(busy()),
        Err(TryLockError::Error(error)) if error.kind() != ErrorKind::Unsupported => {
            return Err(error);
        }
        _ => {}
    }
    let file = Locked::new(file);
    match is_at(&file, path)? {
        true => Ok(file),
        false => Err(busy()),
    }
}

/// Whether `file` is the one at `path`.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let own = file.metadata()?;
    let there = path.symlink_metadata();
    Ok(there.is_ok_and(|there| (there.dev(), there.ino()) == (own.dev(), own.ino())))
}

#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> io::Result<bool> {
    path.try_exists()
}

#[cfg(unix)]
const NO_LINK: i32 = libc::O_NOFOLLOW;
#[cfg(not(unix))]
const NO_LINK: i32 = 0;

/// Opening a pipe waits for its writer unless it is asked not to; regular files know no difference.
#[cfg(unix)]
fn without_waiting(flags: i32) -> OpenOptions {
    use std::os::unix::fs::OpenOptionsExt;
    let mut options = OpenOptions::new();
    options.custom_flags(libc::O_NONBLOCK | libc::O_NOCTTY | flags);
    options
}

#[cfg(not(unix))]
fn without_waiting(_: i32) -> OpenOptions {
    OpenOptions::new()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::process::Command;

    #[test]
    fn a_regular_file_is_read_up_to_its_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "text").unwrap();
        assert_eq!(read_text(&path, 4).unwrap(), "text");
        let refused = read_text(&path, 3).unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::FileTooLarge);
        fs::write(&path, b"\xff").unwrap();
        assert_eq!(
            read_text(&path, 4).unwrap_err().kind(),
            ErrorKind::InvalidData
        );
    }

    #[test]
    fn a_link_to_a_regular_file_is_one() {
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a"), folder.path().join("b"));
        fs::write(&path, "text").unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        assert_eq!(read_text(&link, 4).unwrap(), "text");
        let refused = open_itself(&link).unwrap_err().to_string();
        assert!(refused.contains("it is a link"), "{refused}");
        open_itself(&path).unwrap();
    }

    #[test]
    fn one_alone_holds_a_lock() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let first = lock(&path).unwrap();
        let refused = lock(&path).unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::ResourceBusy);
        // A process started meanwhile has the same open file, as this one does.
        let inherited = first.try_clone().unwrap();
        drop(first);
        let second = lock(&path).unwrap();
        fs::remove_file(&path).unwrap();
        // What the second holds is no longer there, so that it is in nobody's way.
        lock(&path).unwrap();
        drop((second, inherited));
    }

    /// A pipe without a writer is opened at once, and refused.
    #[test]
    fn what_is_no_regular_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(
            open(folder.path()).unwrap_err().kind(),
            ErrorKind::IsADirectory
        );
        let pipe = folder.path().join("pipe");
        assert!(
            Command::new("mkfifo")
                .arg(&pipe)
                .status()
                .unwrap()
                .success()
        );
        for path in [
            pipe.as_path(),
            Path::new("/dev/zero"),
            Path::new("/dev/null"),
        ] {
            let message = open(path).unwrap_err().to_string();
            assert!(message.contains("expected a regular file"), "{message}");
        }
    }
}
