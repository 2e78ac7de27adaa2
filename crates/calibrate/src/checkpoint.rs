//! What a calibration has evaluated, on the disk while the work goes on.
//!
//! The file begins with a line that is its title. Each evaluation of the model is appended when it is done:
//! the digest of its input, the number of its values, the values, and a checksum.
//!
//! A calibration that was interrupted starts again with the same file. It takes the same steps and finds their
//! evaluations there, until the first that is missing. Its results are bit-identical to those of an uninterrupted
//! calibration. Only the evaluation under way is lost. The file is locked as long as it is open.

use files::Locked;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::fmt::{self, Debug, Write as _};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write as _};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// SHA-256 of what an evaluation depends on.
type Key = [u8; 32];

/// Bytes of a number.
const NUMBER: usize = 8;
/// Bytes of the sum of an evaluation, the first of its SHA-256.
const SUM: usize = 8;

/// Evaluations on the disk.
#[derive(Debug)]
pub struct Checkpoint {
    kept: Mutex<Kept>,
}

#[derive(Debug)]
struct Kept {
    file: Locked,
    /// Where the values of each evaluation begin, and how many they are.
    known: HashMap<Key, (u64, usize)>,
    end: u64,
}

impl Checkpoint {
    /// The checkpoint in a file. The file is made new if it does not exist, has another title, or if `anew` is true.
    /// An evaluation that was cut off does not count.
    ///
    /// # Errors
    /// A file that cannot be read or written; [`io::ErrorKind::ResourceBusy`] where another process holds it.
    pub fn open(path: &Path, title: &str, anew: bool) -> io::Result<Self> {
        let mut file = files::lock(path)?;
        if anew || !begins_with(&file, title) {
            file.set_len(0)?;
            file.rewind()?;
            file.write_all(format!("{title}\n").as_bytes())?;
        }
        let length = file.metadata()?.len();
        let mut end = title.len() as u64 + 1;
        let mut known = HashMap::new();
        loop {
            let mut key = Key::default();
            let mut count = [0; NUMBER];
            file.seek(SeekFrom::Start(end))?;
            let read = file.read_exact(&mut key);
            if read.and_then(|()| file.read_exact(&mut count)).is_err() {
                break;
            }
            let values = end + (size_of::<Key>() + NUMBER) as u64;
            let count = u64::from_le_bytes(count);
            let size = count.checked_mul(NUMBER as u64);
            let after = size.and_then(|size| values.checked_add(size)?.checked_add(SUM as u64));
            let Some(after) = after else {
                break;
            };
            let Some(count) = usize::try_from(count).ok().filter(|_| after <= length) else {
                break;
            };
            known.insert(key, (values, count));
            end = after;
        }
        file.set_len(end)?;
        Ok(Self {
            kept: Mutex::new(Kept { file, known, end }),
        })
    }

    /// Whether there is a checkpoint with this title in a file.
    pub fn is_of(path: &Path, title: &str) -> bool {
        files::open(path).is_ok_and(|file| begins_with(&file, title))
    }

    /// The numbers for each of these inputs, which `work` gives for the indices of those that it did not give before. Numbers
    /// that cannot be written are lost, and no more than that.
    pub(crate) fn once_each(
        &self,
        inputs: &[impl Debug],
        work: impl FnOnce(&[usize]) -> Vec<Vec<f64>>,
    ) -> Vec<Vec<f64>> {
        let open = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let keys: Vec<Key> = inputs.iter().map(|input| key(input)).collect();
        let mut known: Vec<_> = keys.iter().map(|key| open().read(key)).collect();
        let missing = (0..keys.len()).filter(|i| known[*i].is_none());
        let missing: Vec<usize> = missing.collect();
        if !missing.is_empty() {
            for (i, values) in missing.iter().zip(work(&missing)) {
                let _lost = open().write(keys[*i], &values);
                known[*i] = Some(values);
            }
        }
        known.into_iter().flatten().collect()
    }
}

impl Kept {
    /// The values of an evaluation; none where they are damaged.
    fn read(&mut self, key: &Key) -> Option<Vec<f64>> {
        let (start, count) = *self.known.get(key)?;
        let mut bytes = vec![0; count * NUMBER + SUM];
        self.file.seek(SeekFrom::Start(start)).ok()?;
        self.file.read_exact(&mut bytes).ok()?;
        let (values, found) = bytes.split_at(count * NUMBER);
        if found != sum(key, values) {
            return None;
        }
        let (numbers, _) = values.as_chunks::<NUMBER>();
        let numbers = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes));
        Some(numbers.collect())
    }

    fn write(&mut self, key: Key, values: &[f64]) -> io::Result<()> {
        let mut bytes = key.to_vec();
        bytes.extend((values.len() as u64).to_le_bytes());
        let numbers: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        bytes.extend(&numbers);
        bytes.extend(sum(&key, &numbers));
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.write_all(&bytes)?;
        let start = self.end + (size_of::<Key>() + NUMBER) as u64;
        self.known.insert(key, (start, values.len()));
        self.end += bytes.len() as u64;
        Ok(())
    }
}

fn begins_with(mut file: &File, title: &str) -> bool {
    let line = format!("{title}\n");
    let mut start = vec![0; line.len()];
    file.read_exact(&mut start).is_ok() && start == line.as_bytes()
}

fn sum(key: &Key, values: &[u8]) -> [u8; SUM] {
    let digest: Key = Sha256::new()
        .chain_update(key)
        .chain_update(values)
        .finalize()
        .into();
    let mut sum = [0; SUM];
    sum.copy_from_slice(&digest[..SUM]);
    sum
}

/// Digest of an input as it shows itself: numbers are shown with all of their digits.
fn key(input: &dyn Debug) -> Key {
    struct Hashed(Sha256);
    impl fmt::Write for Hashed {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            self.0.update(text);
            Ok(())
        }
    }
    let mut hashed = Hashed(Sha256::new());
    let _infallible = write!(hashed, "{input:?}");
    hashed.0.finalize().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn once(
        checkpoint: &Checkpoint,
        input: (&str, f64),
        work: impl FnOnce() -> Vec<f64>,
    ) -> Vec<f64> {
        checkpoint.once_each(&[input], |_| vec![work()]).concat()
    }

    #[test]
    fn what_was_evaluated_is_found_again_after_any_end() {
        let path = std::env::temp_dir().join(format!("checkpoint-{}", std::process::id()));
        let third = [1.0 / 3.0, f64::NEG_INFINITY];
        let first = Checkpoint::open(&path, "of this", false).unwrap();
        let busy = Checkpoint::open(&path, "of this", true).unwrap_err();
        assert_eq!(busy.kind(), io::ErrorKind::ResourceBusy);
        assert_eq!(once(&first, ("a", 0.1), || third.to_vec()), third);
        assert_eq!(once(&first, ("b", 0.1), || vec![2.0]), [2.0]);
        drop(first);
        // Killed in the middle of the second.
        let length = std::fs::metadata(&path).unwrap().len();
        let mut file = std::fs::OpenOptions::new();
        let mut file = file.write(true).open(&path).unwrap();
        file.set_len(length - 3).unwrap();
        assert!(Checkpoint::is_of(&path, "of this") && !Checkpoint::is_of(&path, "of that"));
        let again = Checkpoint::open(&path, "of this", false).unwrap();
        assert_eq!(once(&again, ("a", 0.1), Vec::new), third);
        assert_eq!(once(&again, ("b", 0.1), || vec![3.0]), [3.0]);
        assert_eq!(once(&again, ("b", 0.1), Vec::new), [3.0]);
        // A bit of the first evaluation altered: it is made again.
        let first_value = "of this\n".len() + size_of::<Key>() + NUMBER;
        file.seek(SeekFrom::Start(first_value as u64)).unwrap();
        file.write_all(&[0x54]).unwrap();
        assert_eq!(once(&again, ("a", 0.1), || vec![5.0]), [5.0]);
        assert_eq!(once(&again, ("a", 0.1), Vec::new), [5.0]);
        drop(again);
        let other = Checkpoint::open(&path, "of that", false).unwrap();
        assert_eq!(once(&other, ("a", 0.1), || vec![4.0]), [4.0]);
        std::fs::remove_file(path).unwrap();
    }
}
