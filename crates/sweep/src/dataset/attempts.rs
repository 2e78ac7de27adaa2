//! Attempts at shards. `_sweep/attempts/K.N` stands while attempt N at shard K is under way, and
//! for good where its process ended without a word: killed, out of memory, aborted.
//!
//! After three such attempts at a shard its cases are run one by one, each with a marker
//! `K.CASE.N` of its own. A case under whose markers three processes ended is a case that failed.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::json;

use super::commit::text;
use super::output::Output;
use super::store::process;
use crate::Error;

const FOLDER: &str = "_sweep/attempts";
/// So many processes may end without a word before something is done about it.
const PATIENCE: u64 = 3;
/// Why a case failed under which so many did.
pub(super) const REASON: &str = "the process ended without a word, three times";

/// The attempts of this process that are under way. They end with it, unless it panics.
pub(super) struct Attempts<'a> {
    output: &'a Output,
    under_way: RefCell<BTreeMap<String, String>>,
}

impl<'a> Attempts<'a> {
    /// No attempt yet.
    pub(super) fn new(output: &'a Output) -> Self {
        Self {
            output,
            under_way: RefCell::default(),
        }
    }

    /// Begins one at `what`: a shard, or a case of one (`K.CASE`).
    pub(super) fn begin(&self, what: &str) -> Result<(), Error> {
        // No two attempts have the same record.
        static BEGUN: AtomicU64 = AtomicU64::new(0);
        let number = BEGUN.fetch_add(1, Ordering::Relaxed);
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let since = since.map_or(0, |time| time.as_secs());
        let record = json!({"process": process(), "number": number, "unix_time_s": since});
        let record = text(&record)?;
        for attempt in 1_u64.. {
            let path = format!("{FOLDER}/{what}.{attempt}");
            let before = self.output.store.create_only(&path, &record)?;
            // One that is there already may be this one, whose put was done twice.
            if before.is_none_or(|before| before == record) {
                self.under_way.borrow_mut().insert(what.to_owned(), path);
                break;
            }
        }
        Ok(())
    }

    /// Ends the one at `what`, which came to a result.
    pub(super) fn end(&self, what: &str) {
        if let Some(path) = self.under_way.borrow_mut().remove(what) {
            // One that stays only makes the next attempt more careful.
            let _ = self.output.store.remove(&path);
        }
    }
}

impl Drop for Attempts<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            return;
        }
        for path in self.under_way.borrow().values() {
            // One that stays only makes the next attempt more careful.
            let _ = self.output.store.remove(path);
        }
    }
}

/// How many attempts each shard and each marked case (`K.CASE`) has had that are under way or
/// ended without a word.
pub(super) fn counts(output: &Output) -> Result<BTreeMap<String, u64>, Error> {
    let mut markers: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for name in output.store.names(FOLDER)? {
        if let Some((what, _)) = name.rsplit_once('.') {
            let what = what.to_owned();
            markers.entry(what).or_default().push(name);
        }
    }
    let count = |(what, names): (String, Vec<String>)| {
        let count = match are_too_many(Some(&(names.len() as u64))) {
            true => standing(output, &names)?,
            false => names.len() as u64,
        };
        Ok((what, count))
    };
    markers.into_iter().map(count).collect()
}

/// How many of the markers `names` still stand: a bucket may list for a while what was removed, and
/// nobody is to be blamed for that.
fn standing(output: &Output, names: &[String]) -> Result<u64, Error> {
    let stands = |name: &String| output.store.length(&format!("{FOLDER}/{name}"));
    let lengths = names.iter().map(stands).collect::<Result<Vec<_>, _>>()?;
    Ok(lengths.iter().flatten().count() as u64)
}

/// Whether `count` attempts are too many to go on as before.
pub(super) fn are_too_many(count: Option<&u64>) -> bool {
    count.is_some_and(|&count| count >= PATIENCE)
}
