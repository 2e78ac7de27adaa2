//! Attempts at shards. `_sweep/attempts/K.N` stands while attempt N at shard K is under way, and
//! for good where its process ended without a word: killed, out of memory, aborted.
//!
//! After three such attempts at a shard its cases are run one by one, each with a marker
//! `K.CASE.N` of its own. A case under whose markers three processes ended is a case that failed.

use std::cell::RefCell;
use std::collections::BTreeMap;
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
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let since = since.map_or(0, |time| time.as_secs());
        let record = text(&json!({"process": process(), "unix_time_s": since}))?;
        for attempt in 1_u64.. {
            let path = format!("{FOLDER}/{what}.{attempt}");
            if self.output.store.create_only(&path, &record)?.is_none() {
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
    let mut counts = BTreeMap::new();
    for name in output.store.names(FOLDER)? {
        if let Some((what, _)) = name.rsplit_once('.') {
            *counts.entry(what.to_owned()).or_default() += 1;
        }
    }
    Ok(counts)
}

/// Whether `count` attempts are too many to go on as before.
pub(super) fn are_too_many(count: Option<&u64>) -> bool {
    count.is_some_and(|&count| count >= PATIENCE)
}
