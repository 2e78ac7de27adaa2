//! Attempts at shards. `_sweep/attempts/K.PROCESS` stands while a process is at work on shard K. It
//! stays where the process ended without a result: killed, out of memory, aborted.
//!
//! 1. A process holds a lock on its marker, which the operating system releases at its end. A marker
//!    whose lock is held counts for nothing.
//! 2. Where there are no locks (a bucket), a process puts its marker again every minute. It counts as
//!    ended when its marker is five minutes old by the clock of the storage.
//! 3. A shard that three processes ended in is suspect: its cases are tried one by one ([`super::trial`]).
//!    An end alone says nothing about the cases: a scheduler may have sent it.
//! 4. The markers of a shard are removed with its commit, and all of them when the dataset is complete.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use files::Locked;
use serde::Serialize;

use super::layout::ATTEMPTS;
use super::output::Output;
use super::record::text;
use super::store::{Holder, READERS, process};
use crate::Error;
use crate::in_order::{in_order, pool};

/// The end of the names of trials that are over.
pub(super) const TRIED: &str = ".tried";
/// So many processes may end without a result before the shard's cases are tried.
const PATIENCE: u64 = 3;
/// How often a marker without a lock is put again.
const BEAT: Duration = Duration::from_secs(60);
/// Age at which such a marker counts as that of a process that ended.
const LEASE: Duration = Duration::from_secs(5 * 60);

/// What a marker says.
#[derive(Serialize)]
struct Record<'a> {
    process: &'a str,
    number: u64,
    unix_time_s: u64,
}

/// The processes at a shard that is not made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attended {
    /// Those that are at work on it.
    pub at_work: u64,
    /// Those that ended without a result.
    pub ended: u64,
}

impl Attended {
    /// Whether its cases are to be tried before they are run.
    pub(super) fn is_suspect(self) -> bool {
        self.ended >= PATIENCE
    }
}

/// The attempts of this process that are under way. They end with it, unless it panics.
pub(super) struct Attempts<'a> {
    output: &'a Output,
    under_way: Mutex<BTreeMap<u64, Marker>>,
}

struct Marker {
    path: String,
    record: String,
    /// Held for the time of the attempt; none where the storage knows no locks.
    lock: Option<Locked>,
}

impl<'a> Attempts<'a> {
    /// No attempt yet.
    pub(super) fn new(output: &'a Output) -> Self {
        Self {
            output,
            under_way: Mutex::default(),
        }
    }

    fn under_way(&self) -> MutexGuard<'_, BTreeMap<u64, Marker>> {
        let guard = self.under_way.lock();
        guard.unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins one at shard `shard`.
    pub(super) fn begin(&self, shard: u64) -> Result<(), Error> {
        if self.under_way().contains_key(&shard) {
            return Ok(());
        }
        // No two attempts have the same marker.
        static BEGUN: AtomicU64 = AtomicU64::new(0);
        let number = BEGUN.fetch_add(1, Ordering::Relaxed);
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let since = since.map_or(0, |time| time.as_secs());
        let record = text(&Record {
            process: process(),
            number,
            unix_time_s: since,
        })?;
        let path = format!("{ATTEMPTS}/{shard}.{}-{number}", process());
        let lock = self.output.store.hold(&path, &record)?;
        let marker = Marker { path, record, lock };
        self.under_way().insert(shard, marker);
        Ok(())
    }

    /// Ends the one at shard `shard`, which is made.
    pub(super) fn end(&self, shard: u64) {
        let marker = self.under_way().remove(&shard);
        // One that stays only makes the next attempt more careful.
        if let Some(marker) = marker {
            let _ = self.output.store.remove(&marker.path);
        }
    }

    /// Does `work`, and renews the markers without a lock meanwhile.
    pub(super) fn kept_alive<T>(&self, work: impl FnOnce() -> T) -> T {
        thread::scope(|scope| {
            let (under_way, over) = channel::<()>();
            scope.spawn(move || {
                while over.recv_timeout(BEAT) == Err(RecvTimeoutError::Timeout) {
                    self.renew();
                }
            });
            let done = work();
            drop(under_way);
            done
        })
    }

    fn renew(&self) {
        for marker in self.under_way().values().filter(|m| m.lock.is_none()) {
            // One that is not renewed only makes the next attempt more careful.
            let _ = self
                .output
                .store
                .write(&marker.path, marker.record.as_bytes());
        }
    }
}

impl Drop for Attempts<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            return;
        }
        for marker in self.under_way().values() {
            // One that stays only makes the next attempt more careful.
            let _ = self.output.store.remove(&marker.path);
        }
    }
}

/// The processes at each shard that `of` names.
pub(super) fn counts(
    output: &Output,
    of: impl Fn(u64) -> bool,
) -> Result<BTreeMap<u64, Attended>, Error> {
    let names = output.store.names(ATTEMPTS)?.into_iter();
    let names = names.filter(|name| !name.ends_with(TRIED));
    let names = names.filter_map(|name| Some((shard_of(&name)?, format!("{ATTEMPTS}/{name}"))));
    let clock = OnceLock::new();
    let mut counts: BTreeMap<u64, Attended> = BTreeMap::new();
    in_order(
        &pool(READERS)?,
        4 * READERS,
        names.filter(|(shard, _)| of(*shard)),
        |(_, path)| is_at_work(output, path, &clock),
        |(shard, _), at_work| {
            let Some(at_work) = at_work? else {
                return Ok(());
            };
            let attended = counts.entry(shard).or_default();
            match at_work {
                true => attended.at_work += 1,
                false => attended.ended += 1,
            }
            Ok::<(), Error>(())
        },
    )?;
    Ok(counts)
}

/// Whether the process of a marker is at work; none where the marker is gone, which a bucket may list
/// for a while. `clock` is the time by the storage, once it has been asked.
fn is_at_work(
    output: &Output,
    path: &str,
    clock: &OnceLock<Option<SystemTime>>,
) -> Result<Option<bool>, Error> {
    match output.store.holder(path)? {
        None => Ok(None),
        Some(Holder::AtWork) => Ok(Some(true)),
        Some(Holder::Ended) => Ok(Some(false)),
        Some(Holder::Unknown) => {
            let Some(renewed) = output.store.modified(path)? else {
                return Ok(None);
            };
            // Without permission to write there is no time, and the process counts as at work.
            let now = clock.get_or_init(|| output.store.now().ok());
            let age = now.and_then(|now| now.duration_since(renewed).ok());
            Ok(Some(age.is_none_or(|age| age < LEASE)))
        }
    }
}

/// Removes every marker and trial of the shards that `of` names.
pub(super) fn forget(output: &Output, of: impl Fn(u64) -> bool) -> Result<(), Error> {
    for name in output.store.names(ATTEMPTS)? {
        if shard_of(&name).is_some_and(&of) {
            output.store.remove(&format!("{ATTEMPTS}/{name}"))?;
        }
    }
    Ok(())
}

/// The shard of the marker or trial `name`.
pub(super) fn shard_of(name: &str) -> Option<u64> {
    name.split_once('.')?.0.parse().ok()
}
