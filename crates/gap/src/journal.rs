//! What was found already, and what it cost: an explanation that was stopped goes on from there.
//!
//! Each line of the file holds the key of a piece of work, its result and its cost. The key is a digest
//! of everything that the result depends on, recordings and version included, so that a line is never
//! taken for another. The cost counts again when a result is found there, so that what is left of a
//! budget does not depend on whether the work was interrupted.

use crate::error::Error;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::{Debug, Write as _};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Results of finished work. Copies share them.
#[derive(Clone, Debug, Default)]
pub struct Journal {
    kept: Option<Arc<Mutex<Kept>>>,
    spent: Arc<AtomicU64>,
}

/// The result of a piece of work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Finished {
    /// What was found.
    pub numbers: Vec<f64>,
    /// Evaluations that it took, each run counting as one.
    pub cost: u64,
}

#[derive(Debug)]
struct Kept {
    known: BTreeMap<String, Finished>,
    file: File,
}

#[derive(Serialize, Deserialize)]
struct Line {
    key: String,
    #[serde(flatten)]
    finished: Finished,
}

impl Journal {
    /// The journal in a file, which is made where there is none. A last line that was cut off does
    /// not count.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let failed = |source| Error::Journal {
            path: path.to_owned(),
            source,
        };
        let text = match path.exists() {
            true => std::fs::read_to_string(path).map_err(failed)?,
            false => String::new(),
        };
        let lines = text.lines().filter_map(|l| serde_json::from_str(l).ok());
        let known = lines.map(|line: Line| (line.key, line.finished)).collect();
        let mut options = OpenOptions::new();
        let mut file = options
            .create(true)
            .append(true)
            .open(path)
            .map_err(failed)?;
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n").map_err(failed)?;
        }
        Ok(Self {
            kept: Some(Arc::new(Mutex::new(Kept { known, file }))),
            spent: Arc::default(),
        })
    }

    /// What all work has cost so far, that of earlier sessions included.
    pub fn spent(&self) -> u64 {
        self.spent.load(Ordering::Relaxed)
    }

    /// The numbers that `work` gives, or gave before for the same `input`.
    ///
    /// # Errors
    /// Those of `work`. A line that cannot be written is lost, and no more than that.
    pub(crate) fn once(
        &self,
        input: &dyn Debug,
        work: impl FnOnce() -> Result<Finished, Error>,
    ) -> Result<Vec<f64>, Error> {
        let finished = match &self.kept {
            Some(kept) => Self::kept(kept, key(input), work)?,
            None => work()?,
        };
        self.spent.fetch_add(finished.cost, Ordering::Relaxed);
        Ok(finished.numbers)
    }

    fn kept(
        kept: &Mutex<Kept>,
        key: String,
        work: impl FnOnce() -> Result<Finished, Error>,
    ) -> Result<Finished, Error> {
        let open = || kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(finished) = open().known.get(&key) {
            return Ok(finished.clone());
        }
        let finished = work()?;
        let line = Line { key, finished };
        if let Ok(mut text) = serde_json::to_string(&line) {
            text.push('\n');
            let _lost = open().file.write_all(text.as_bytes());
        }
        Ok(line.finished)
    }
}

/// Digest of an input as it shows itself: numbers are shown with all of their digits.
fn key(input: &dyn Debug) -> String {
    let mut text = env!("CARGO_PKG_VERSION").to_owned();
    let digest = match write!(text, "{input:?}") {
        Ok(()) => Sha256::digest(text.as_bytes()),
        Err(_) => Sha256::digest([]),
    };
    digest.iter().fold(String::new(), |mut hex, byte| {
        let _infallible = write!(hex, "{byte:02x}");
        hex
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(number: f64) -> Result<Finished, Error> {
        let numbers = vec![number];
        Ok(Finished { numbers, cost: 7 })
    }

    #[test]
    fn what_was_found_is_found_again_and_nothing_else() {
        let path = std::env::temp_dir().join(format!("journal-{}", std::process::id()));
        let third = 1.0 / 3.0;
        let first = Journal::open(&path).unwrap();
        let numbers = first.once(&("a", third), || found(third)).unwrap();
        assert_eq!((numbers, first.spent()), (vec![third], 7));
        // Cut off in the middle of a line.
        let mut file = OpenOptions::new().append(true).open(&path).unwrap();
        file.write_all(b"{\"key\": \"0").unwrap();
        let again = Journal::open(&path).unwrap();
        let numbers = again.once(&("a", third), || found(0.0)).unwrap();
        assert_eq!((numbers, again.spent()), (vec![third], 7));
        let other = again.once(&("a", 0.333), || found(2.0)).unwrap();
        assert_eq!(other, [2.0]);
        let last = Journal::open(&path).unwrap();
        assert_eq!(last.once(&("a", 0.333), || found(0.0)).unwrap(), [2.0]);
        std::fs::remove_file(path).unwrap();
    }
}
