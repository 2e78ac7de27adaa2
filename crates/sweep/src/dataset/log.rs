//! What a process did at a dataset, and when: `_sweep/logs/NAME.PROCESS.log`, a line for each event.
//!
//! In a folder a line is there at once; in a bucket, where nothing is appended to, the log is put again
//! every minute and at the end. The work does not depend on it: a log that cannot be written is left out.

use std::fmt::{self, Display};
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use super::layout::LOGS;
use super::store::{Store, process};

/// How often the log in a bucket is put again.
const PUT_EVERY: Duration = Duration::from_secs(60);

/// The log of this process, which begins with its first line.
#[derive(Debug, Default)]
pub(super) struct Log(Mutex<Open>);

#[derive(Debug, Default)]
struct Open {
    /// What the process does: `gen-dataset`, `shard-17`.
    name: String,
    /// In a folder.
    file: Option<File>,
    /// In a bucket: all lines so far, and when they were put.
    text: String,
    put: Option<Instant>,
}

impl Log {
    fn open(&self) -> MutexGuard<'_, Open> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Names what the process does: `gen-dataset`, `shard-17`.
    pub(super) fn begin(&self, name: &str) {
        name.clone_into(&mut self.open().name);
    }

    /// Appends a line to the log, which is kept in `store`.
    pub(super) fn say(&self, store: &Store, what: impl Display) {
        let mut log = self.open();
        let line = format!("{} {what}\n", utc(SystemTime::now()));
        let Some(folder) = store.folder() else {
            log.text += &line;
            match log.put {
                None => log.put = Some(Instant::now()),
                Some(put) if put.elapsed() > PUT_EVERY => log.put(store),
                Some(_) => {}
            }
            return;
        };
        if log.file.is_none() {
            let path = folder.join(path(&log.name));
            let _ = fs::create_dir_all(folder.join(LOGS));
            log.file = OpenOptions::new().create(true).append(true).open(path).ok();
        }
        if let Some(file) = &mut log.file {
            let _ = file.write_all(line.as_bytes());
        }
    }

    /// Puts the log of a bucket a last time.
    pub(super) fn end(&self, store: &Store) {
        let mut log = self.open();
        if log.put.is_some() {
            log.put(store);
        }
    }
}

impl Open {
    fn put(&mut self, store: &Store) {
        let _ = store.write(&path(&self.name), self.text.as_bytes());
        self.put = Some(Instant::now());
    }
}

fn path(name: &str) -> String {
    format!("{LOGS}/{name}.{}.log", process())
}

/// How fast cases are made.
pub(super) struct Pace {
    begun: Instant,
    all: u64,
    done: u64,
}

impl Pace {
    /// None yet of `all` cases.
    pub(super) fn new(all: u64) -> Self {
        Self {
            begun: Instant::now(),
            all,
            done: 0,
        }
    }

    /// All cases.
    pub(super) fn cases(&self) -> u64 {
        self.all
    }

    /// One more.
    pub(super) fn add(&mut self) {
        self.done += 1;
    }
}

impl Display for Pace {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let seconds = self.begun.elapsed().as_secs_f64();
        let rate = self.done as f64 / seconds.max(1e-3);
        let left = self.all.saturating_sub(self.done) as f64 / rate.max(1e-9);
        let (done, all) = (self.done, self.all);
        write!(
            f,
            "{done} of {all} cases in {seconds:.1} s, {rate:.3} a second, {left:.0} s left"
        )
    }
}

/// A time as `2026-11-22T14:40:23Z`, by the calendar of Gregory (days from the civil date after
/// Hinnant 2013).
pub fn utc(time: SystemTime) -> String {
    let seconds = time
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs());
    let (days, of_day) = (seconds / 86_400, seconds % 86_400);
    // Days since 1 March of the year 0, in cycles of 400 years.
    let shifted = days + 719_468;
    let (cycle, day) = (shifted / 146_097, shifted % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year + cycle * 400 + u64::from(month <= 2);
    let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::utc;
    use std::time::{Duration, UNIX_EPOCH};

    #[test]
    fn times_are_those_of_the_calendar() {
        for (seconds, expected) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_709_251_200, "2024-03-01T00:00:00Z"),
            (1_798_761_599, "2026-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(utc(UNIX_EPOCH + Duration::from_secs(seconds)), expected);
        }
    }
}
