//! Results that were found already, and their cost: an explanation that was stopped continues from there.
//!
//! Each line of the file holds the key of a piece of work, its result and its cost, and a checksum. A line that
//! was altered or cut off does not count. The key is a digest of everything that the result depends on,
//! recordings and version included, so that a line is never taken for another. The file is locked as long as it
//! is open. The cost counts again when a result is found there. What is left of a budget therefore does not
//! depend on whether the work was interrupted.

use crate::error::Error;
use files::Locked;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::{Debug, Write as _};
use std::io::{Read, Write};
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
    file: Locked,
}

#[derive(Serialize, Deserialize)]
struct Line {
    key: String,
    #[serde(flatten)]
    finished: Finished,
}

impl Line {
    fn write(&self) -> Result<String, serde_json::Error> {
        let text = serde_json::to_string(self)?;
        let sum = digest(text.as_bytes());
        Ok(format!("{text} {sum}\n"))
    }

    /// A line as it was written, without its end.
    fn read(line: &[u8]) -> Option<Self> {
        let (text, sum) = str::from_utf8(line).ok()?.rsplit_once(' ')?;
        match digest(text.as_bytes()) == sum {
            true => serde_json::from_str(text).ok(),
            false => None,
        }
    }
}

impl Journal {
    /// The journal in a file, which is made if it does not exist.
    ///
    /// # Errors
    /// A file that cannot be read or written, or that another process is at work with.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let failed = |source| Error::Journal {
            path: path.to_owned(),
            source,
        };
        let mut file = files::lock(path).map_err(failed)?;
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(failed)?;
        let lines = text.split(|byte| *byte == b'\n').filter_map(Line::read);
        let known = lines.map(|line| (line.key, line.finished)).collect();
        if text.last().is_some_and(|last| *last != b'\n') {
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
        if let Ok(text) = line.write() {
            let _lost = open().file.write_all(text.as_bytes());
        }
        Ok(line.finished)
    }
}

/// Digest of an input as it shows itself: numbers are shown with all of their digits.
fn key(input: &dyn Debug) -> String {
    let mut text = env!("CARGO_PKG_VERSION").to_owned();
    let _infallible = write!(text, "{input:?}");
    digest(text.as_bytes())
}

/// SHA-256 in hexadecimal digits.
fn digest(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().fold(String::new(), |mut hex, byte| {
        let _infallible = write!(hex, "{byte:02x}");
        hex
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finished(number: f64) -> Result<Finished, Error> {
        let numbers = vec![number];
        Ok(Finished { numbers, cost: 7 })
    }

    #[test]
    fn what_was_found_is_found_again_and_nothing_else() {
        let path = std::env::temp_dir().join(format!("journal-{}", std::process::id()));
        let third = 1.0 / 3.0;
        let first = Journal::open(&path).unwrap();
        let numbers = first.once(&("a", third), || finished(third)).unwrap();
        assert_eq!((numbers, first.spent()), (vec![third], 7));
        assert!(Journal::open(&path).is_err(), "it is locked");
        drop(first);
        // Cut off in the middle of a line.
        let mut text = std::fs::read_to_string(&path).unwrap();
        text.push_str("{\"key\": \"0");
        std::fs::write(&path, text).unwrap();
        let again = Journal::open(&path).unwrap();
        let numbers = again.once(&("a", third), || finished(0.0)).unwrap();
        assert_eq!((numbers, again.spent()), (vec![third], 7));
        let other = again.once(&("a", 0.333), || finished(2.0)).unwrap();
        assert_eq!(other, [2.0]);
        drop(again);
        let last = Journal::open(&path).unwrap();
        assert_eq!(last.once(&("a", 0.333), || finished(0.0)).unwrap(), [2.0]);
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn every_number_is_found_again_to_the_last_bit() {
        let path = std::env::temp_dir().join(format!("journal-bits-{}", std::process::id()));
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        let numbers: Vec<f64> = (0..10_000)
            .map(|_| {
                bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                f64::from_bits(bits)
            })
            .filter(|number| number.is_finite())
            .collect();
        let work = |numbers: &[f64]| {
            let numbers = numbers.to_vec();
            move || Ok(Finished { numbers, cost: 1 })
        };
        let first = Journal::open(&path).unwrap();
        first.once(&"all", work(&numbers)).unwrap();
        drop(first);
        let found = Journal::open(&path).unwrap().once(&"all", work(&[]));
        assert!(found.unwrap() == numbers);
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn a_number_that_was_altered_is_not_believed() {
        let path = std::env::temp_dir().join(format!("journal-sum-{}", std::process::id()));
        let first = Journal::open(&path).unwrap();
        first.once(&"a", || finished(1.5)).unwrap();
        drop(first);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("1.5"), "{text}");
        std::fs::write(&path, text.replace("1.5", "2.5")).unwrap();
        let again = Journal::open(&path).unwrap();
        assert_eq!(again.once(&"a", || finished(1.5)).unwrap(), [1.5]);
        std::fs::remove_file(path).unwrap();
    }
}
