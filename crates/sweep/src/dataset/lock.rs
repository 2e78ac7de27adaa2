//! Locks of a dataset in a folder. One process that makes the whole dataset holds `_sweep/lock`
//! alone; processes that make a shard each share it. `_sweep/commit.lock` is held while the files
//! of a shard get their names. The operating system releases the locks when a process ends, in any
//! way. Buckets have no locks.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use files::Locked;

use crate::Error;

/// So long is waited for a process that tidies up.
const MOMENT: Duration = Duration::from_secs(2);

/// A locked file.
#[derive(Debug)]
pub(super) struct Lock {
    file: Locked,
    /// Whether no other process holds it.
    pub(super) alone: bool,
}

impl Drop for Lock {
    fn drop(&mut self) {
        if self.alone {
            // An empty lock file: the folder of a finished dataset is the same whoever wrote it.
            let _ = self.file.set_len(0);
        }
    }
}

/// Locks `_sweep/lock`, and writes this process's number into it for whoever comes second.
pub(super) fn lock(root: &Path) -> Result<Lock, Error> {
    let (file, unwritable) = open(root, "_sweep/lock")?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => return Err(in_use(root, file)),
        Err(TryLockError::Error(source)) => return Err(unwritable(source)),
    }
    let mut file = Locked::new(file);
    let mut sign = || {
        file.set_len(0)?;
        file.seek(SeekFrom::Start(0))?;
        write!(file, "process {}", std::process::id())
    };
    sign().map_err(unwritable)?;
    Ok(Lock { file, alone: true })
}

/// Locks `_sweep/lock` together with others; nothing where the file system knows no locks, because
/// the records of a dataset do not need them.
pub(super) fn lock_shared(root: &Path) -> Result<Option<Lock>, Error> {
    let (file, unwritable) = open(root, "_sweep/lock")?;
    // Whoever tidies up holds it for a moment.
    let begun = Instant::now();
    let locked = loop {
        match file.try_lock_shared() {
            Err(TryLockError::WouldBlock) if begun.elapsed() < MOMENT => thread::sleep(MOMENT / 20),
            tried => break tried,
        }
    };
    match locked {
        Ok(()) => Ok(Some(Lock {
            file: Locked::new(file),
            alone: false,
        })),
        Err(TryLockError::WouldBlock) => Err(in_use(root, file)),
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(None),
        Err(TryLockError::Error(source)) => Err(unwritable(source)),
    }
}

fn open(root: &Path, name: &str) -> Result<(File, impl Fn(io::Error) -> Error + use<>), Error> {
    let path = root.join(name);
    let mut options = OpenOptions::new();
    let options = options.read(true).write(true).create(true).truncate(false);
    let file = options.open(&path);
    let unwritable = move |source| Error::Unwritable {
        path: path.clone(),
        source,
    };
    Ok((file.map_err(&unwritable)?, unwritable))
}

fn in_use(root: &Path, mut lock: File) -> Error {
    let mut by = String::new();
    let _ = lock.read_to_string(&mut by);
    Error::InUse {
        path: root.to_owned(),
        by: if by.is_empty() {
            "one that makes a shard".into()
        } else {
            by
        },
    }
}

/// Does `work` if no other process holds the lock of the dataset at `root`; this process holds
/// `own` of it. Does nothing if another process holds it, or without locks.
pub(super) fn alone(
    root: &Path,
    own: &Mutex<Option<Lock>>,
    work: impl FnOnce() -> Result<(), Error>,
) -> Result<(), Error> {
    let mut own = own.lock().unwrap_or_else(PoisonError::into_inner);
    if own.as_ref().is_some_and(|lock| lock.alone) {
        return work();
    }
    // A lock held together with others does not become one held alone in one step.
    *own = None;
    let (file, _) = open(root, "_sweep/lock")?;
    let done = match file.try_lock() {
        Ok(()) => {
            let _alone = Locked::new(file);
            work()
        }
        Err(_) => Ok(()),
    };
    *own = lock_shared(root)?;
    done
}

/// Locks `_sweep/commit.lock`: together with others, or `alone`; nothing where there are no locks.
pub(super) fn lock_commits(root: &Path, alone: bool) -> Result<Option<Locked>, Error> {
    let (file, _) = open(root, "_sweep/commit.lock")?;
    let locked = match alone {
        true => file.lock(),
        false => file.lock_shared(),
    };
    Ok(locked.is_ok().then(|| Locked::new(file)))
}
