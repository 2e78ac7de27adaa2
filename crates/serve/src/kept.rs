//! What was made of a folder's files, kept until these change.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// Files and folders that are written beside those that a page is made of.
const NOT_CONTENT: [&str; 2] = ["_sweep", "figures"];

/// The files of a folder at one time: their names, lengths and times of writing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Stamp(Vec<(String, u64, Option<SystemTime>)>);

impl Stamp {
    /// The files and folders in `folder`, but for pages.
    ///
    /// # Errors
    /// A folder that cannot be read, or one with a link that leads out of `root`, which is canonical.
    pub(crate) fn read(folder: &Path, root: &Path) -> io::Result<Self> {
        let mut stamp = Vec::new();
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            let Ok(found) = path.metadata() else {
                // It has gone, or is a link to nothing.
                continue;
            };
            if path.is_symlink() && !path.canonicalize()?.starts_with(root) {
                let reason = format!(
                    "{} is a link that leads out of the folder that is served",
                    path.display()
                );
                return Err(io::Error::new(io::ErrorKind::PermissionDenied, reason));
            }
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            if !NOT_CONTENT.contains(&name.as_str())
                && !name.ends_with(".html")
                && !name.ends_with(".part")
            {
                stamp.push((name, found.len(), found.modified().ok()));
            }
        }
        stamp.sort_unstable();
        Ok(Self(stamp))
    }
}

/// The folder, and what is made of it.
pub(crate) type Key = (PathBuf, String);

/// Things made of folders, of which those that were used last are kept.
pub(crate) struct Kept<T> {
    /// The most that all of them may take.
    most: usize,
    all: Mutex<Slots<T>>,
}

struct Slots<T> {
    used: u64,
    by_key: BTreeMap<Key, Slot<T>>,
}

/// A thing and the files that it was made of; none before it is made.
type Made<T> = Mutex<Option<(Stamp, Arc<T>)>>;

struct Slot<T> {
    used: u64,
    size: usize,
    made: Arc<Made<T>>,
}

impl<T> Kept<T> {
    /// Keeps things of `most` together, in the unit of their sizes.
    pub(crate) fn new(most: usize) -> Self {
        let all = Slots {
            used: 0,
            by_key: BTreeMap::new(),
        };
        Self {
            most,
            all: Mutex::new(all),
        }
    }

    fn all(&self) -> MutexGuard<'_, Slots<T>> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What was made under `key` of the files of `stamp`, if it is kept.
    pub(crate) fn find(&self, key: &Key, stamp: &Stamp) -> Option<Arc<T>> {
        let mut all = self.all();
        all.used += 1;
        let used = all.used;
        let slot = all.by_key.get_mut(key)?;
        slot.used = used;
        // One that is being made is not there yet.
        let made = slot.made.try_lock().ok()?;
        let (of, thing) = made.as_ref()?;
        (of == stamp).then(|| Arc::clone(thing))
    }

    /// As [`Self::find`], or else what `make` gives, of this size. Of two that ask at the same time one makes it.
    ///
    /// # Errors
    /// Those of `make`; then nothing is kept.
    pub(crate) fn get<E>(
        &self,
        key: &Key,
        stamp: Stamp,
        size: impl Fn(&T) -> usize,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<Arc<T>, E> {
        let slot = {
            let mut all = self.all();
            all.used += 1;
            let used = all.used;
            let slot = all.by_key.entry(key.clone()).or_insert_with(|| Slot {
                used,
                size: 0,
                made: Arc::default(),
            });
            slot.used = used;
            Arc::clone(&slot.made)
        };
        let mut made = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, thing)) = made.as_ref()
            && *of == stamp
        {
            return Ok(Arc::clone(thing));
        }
        *made = None;
        let thing = Arc::new(make()?);
        *made = Some((stamp, Arc::clone(&thing)));
        drop(made);
        self.make_room(key, size(&thing));
        Ok(thing)
    }

    /// Notes the size of what is under `key`, and removes others that were used least recently until all fit.
    fn make_room(&self, key: &Key, size: usize) {
        let mut all = self.all();
        if let Some(slot) = all.by_key.get_mut(key) {
            slot.size = size;
        }
        while all.by_key.values().map(|slot| slot.size).sum::<usize>() > self.most {
            let others = all
                .by_key
                .iter()
                .filter(|(other, slot)| *other != key && slot.size > 0);
            let oldest = others.min_by_key(|(_, slot)| slot.used);
            let Some(oldest) = oldest.map(|(other, _)| other.clone()) else {
                return;
            };
            all.by_key.remove(&oldest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::time::Duration;

    fn key(name: &str) -> Key {
        (PathBuf::new(), name.to_owned())
    }

    fn get(kept: &Kept<u32>, name: &str, stamp: &Stamp, value: u32) -> u32 {
        let made = kept.get(&key(name), stamp.clone(), |_| 1, || Ok::<u32, ()>(value));
        *made.unwrap()
    }

    #[test]
    fn a_thing_is_made_again_when_its_files_change() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        let stamp = || Stamp::read(&root, &root).unwrap();
        let path = root.join("manifest.json");
        fs::write(&path, "a").unwrap();
        let kept = Kept::new(2);
        assert_eq!(get(&kept, "a", &stamp(), 1), 1);
        assert_eq!(get(&kept, "a", &stamp(), 2), 1);
        // A page beside it is none of its files.
        fs::write(root.join("report.html"), "page").unwrap();
        assert_eq!(get(&kept, "a", &stamp(), 3), 1);
        // Another length, then the same length at another time.
        fs::write(&path, "bb").unwrap();
        assert_eq!(get(&kept, "a", &stamp(), 4), 4);
        let before = path.metadata().unwrap().modified().unwrap();
        let file = File::options().write(true).open(&path).unwrap();
        file.set_modified(before - Duration::from_secs(1)).unwrap();
        assert_eq!(get(&kept, "a", &stamp(), 5), 5);
    }

    #[test]
    fn what_was_used_least_recently_goes_first() {
        let (kept, stamp) = (Kept::new(2), Stamp::default());
        get(&kept, "a", &stamp, 1);
        get(&kept, "b", &stamp, 2);
        assert_eq!(kept.find(&key("a"), &stamp).as_deref(), Some(&1));
        get(&kept, "c", &stamp, 3);
        let found = ["a", "b", "c"].map(|name| kept.find(&key(name), &stamp).is_some());
        assert_eq!(found, [true, false, true]);
    }

    #[test]
    fn a_failure_is_not_kept() {
        let (kept, stamp) = (Kept::new(2), Stamp::default());
        let failed = kept.get(&key("a"), stamp.clone(), |_: &u32| 1, || Err("no"));
        assert_eq!(failed.unwrap_err(), "no");
        assert_eq!(get(&kept, "a", &stamp, 7), 7);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_out_of_the_folder_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        fs::create_dir(root.join("inside")).unwrap();
        fs::write(root.join("a"), "").unwrap();
        let link = root.join("inside/sweep.yaml");
        std::os::unix::fs::symlink(root.join("a"), &link).unwrap();
        let (inside, stamp) = (root.join("inside"), |root: &Path| {
            Stamp::read(&root.join("inside"), root)
        });
        stamp(&root).unwrap();
        let refused = Stamp::read(&inside, &inside).unwrap_err();
        assert_eq!(refused.kind(), io::ErrorKind::PermissionDenied);
    }
}
