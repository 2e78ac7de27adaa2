//! What says that a shard is finished: `_sweep/commits/K.json`, written once, after its files; and
//! the same for bifurcation diagrams.
//!
//! 1. A shard that is run twice (after a crash, or by two machines at once) writes the same files
//!    under the same names. Its second commit finds the first and must agree with it.
//! 2. A result in which a case has rows replaces one in which the same case died.
//! 3. A record that cannot be read counts as not written, and so does one whose files are damaged: the
//!    shard is made again.

use std::collections::{BTreeMap, BTreeSet};

use recordings::{CaseWarning, FailedCase, FileEntry};
use serde::{Deserialize, Serialize};

use super::check::{Check, damage_of};
use super::output::Output;
use super::record::{checksum, text};
use crate::{Error, Plan};

/// A finished shard.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Commit {
    /// The plan that it belongs to.
    pub plan_id: String,
    /// Its number.
    pub shard: u64,
    /// Its first case, and one past its last.
    pub cases: [u64; 2],
    /// Its files.
    pub files: Vec<FileEntry>,
    /// Rows by split, then by fault.
    pub rows: BTreeMap<String, BTreeMap<String, u64>>,
    /// The cases that failed.
    pub failed: Vec<FailedCase>,
    /// What is doubtful about cases.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<CaseWarning>,
}

/// What stands for a shard or a diagram.
pub(super) enum Found<T> {
    /// No record.
    Nothing,
    /// A record that cannot be parsed, or files that differ from it. A warning was kept.
    Damaged,
    /// The record, and its files.
    Made(T),
}

/// Which of two results of one shard stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standing {
    /// They are the same.
    Same,
    /// The new one.
    New,
    /// The one before.
    Before,
    /// Neither: they should be the same and are not.
    Differ,
}

impl Commit {
    /// Which of this new result and the one `before` stands. One in which a case has rows stands
    /// against one in which the same case died; with `retried`, against one in which it failed for
    /// whatever reason.
    pub(super) fn against(&self, before: &Self, retried: bool) -> Standing {
        let lost = |commit: &Self| -> BTreeSet<String> {
            let failed = commit.failed.iter().filter(|case| case.died || retried);
            failed.map(|case| case.case_id.clone()).collect()
        };
        let (now, then) = (lost(self), lost(before));
        if now == then {
            // Two hosts may end one process by different signals.
            return match self.without_deaths() == before.without_deaths() {
                true => Standing::Same,
                false => Standing::Differ,
            };
        }
        match now.is_subset(&then) || (!then.is_subset(&now) && now.len() < then.len()) {
            true => Standing::New,
            false => Standing::Before,
        }
    }

    /// The record without how its cases died.
    fn without_deaths(&self) -> Self {
        let mut record = self.clone();
        let died = record.failed.iter_mut().filter(|case| case.died);
        died.for_each(|case| case.reason.clear());
        record
    }

    /// Whether a case of it died.
    pub(super) fn has_deaths(&self) -> bool {
        self.failed.iter().any(|case| case.died)
    }

    /// The error of a shard whose two results should be the same.
    pub(super) fn differs(&self, before: &Self) -> Result<Error, Error> {
        Ok(Error::NotDeterministic {
            part: part(self.shard),
            first: checksum(&text(before)?),
            second: checksum(&text(self)?),
        })
    }

    /// Writes the record unless the shard has one, which is then returned.
    pub(super) fn create(&self, output: &Output, plan: &Plan) -> Result<Option<Self>, Error> {
        let name = name(self.shard);
        let Some(before) = output.store.create_only(&name, &text(self)?)? else {
            return Ok(None);
        };
        match Self::parse(&before, plan, self.shard) {
            Ok(before) => Ok(Some(before)),
            Err(_) => self.replace(output).map(|()| None),
        }
    }

    /// Writes the record in place of any other.
    pub(super) fn replace(&self, output: &Output) -> Result<(), Error> {
        let record = text(self)?;
        output.store.write(&name(self.shard), record.as_bytes())?;
        Ok(())
    }

    /// What stands for shard `shard`.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub(super) fn find(
        output: &Output,
        plan: &Plan,
        shard: u64,
        check: Check,
    ) -> Result<Found<Self>, Error> {
        find(
            output,
            &name(shard),
            &part(shard),
            |record| Self::parse(record, plan, shard),
            |commit| &commit.files,
            check,
        )
    }

    /// The record of a shard, if it is finished and its files are there.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub(super) fn read(
        output: &Output,
        plan: &Plan,
        shard: u64,
        check: Check,
    ) -> Result<Option<Self>, Error> {
        Self::find(output, plan, shard, check).map(Found::made)
    }

    /// The record that is written as `record`, if it can be that of shard `shard`.
    fn parse(record: &[u8], plan: &Plan, shard: u64) -> Result<Self, String> {
        let commit: Self = serde_json::from_slice(record).map_err(|error| error.to_string())?;
        match commit.plan_id == plan.id && commit.is_of(plan, shard) {
            true => Ok(commit),
            false => Err("its plan, cases, rows or failures are not those of the shard".into()),
        }
    }

    /// Whether its numbers can be those of shard `shard`: every case has its rows or has failed.
    fn is_of(&self, plan: &Plan, shard: u64) -> bool {
        let cases = plan.shard(shard);
        let windows = plan.windows.map_or(1, |windows| windows.count.get());
        let counts = self.rows.values().flat_map(|faults| faults.values());
        let rows = counts.map(|&count| u128::from(count)).sum::<u128>();
        let failed = self.failed.len() as u128;
        let whole = (rows / u128::from(windows), rows % u128::from(windows));
        let count = u128::from(cases.end - cases.start);
        self.shard == shard
            && self.cases == [cases.start, cases.end]
            && (whole.0 + failed, whole.1) == (count, 0)
    }
}

impl<T> Found<T> {
    /// The record, if the shard or diagram is made.
    pub(super) fn made(self) -> Option<T> {
        match self {
            Self::Made(record) => Some(record),
            Self::Nothing | Self::Damaged => None,
        }
    }
}

fn name(shard: u64) -> String {
    format!("_sweep/commits/{shard}.json")
}

fn part(shard: u64) -> String {
    format!("shard {shard}")
}

/// A finished bifurcation diagram: `_sweep/commits/bifurcation-NAME.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagramCommit {
    /// The plan that it belongs to.
    pub plan_id: String,
    /// Its file.
    pub file: FileEntry,
}

impl DiagramCommit {
    /// Says that diagram `diagram` is finished.
    ///
    /// # Errors
    /// Where it was finished before with another file, or the record cannot be written.
    pub(super) fn create(&self, output: &Output, plan: &Plan, diagram: &str) -> Result<(), Error> {
        let now = text(self)?;
        let before = output.store.create_only(&diagram_name(diagram), &now)?;
        let before = before.map(|before| Self::parse(&before, plan));
        match before {
            Some(Ok(before)) if before != *self => Err(Error::NotDeterministic {
                part: diagram_part(diagram),
                first: checksum(&text(&before)?),
                second: checksum(&now),
            }),
            Some(Err(_)) => self.replace(output, diagram),
            _ => Ok(()),
        }
    }

    /// Writes the record in place of any other.
    pub(super) fn replace(&self, output: &Output, diagram: &str) -> Result<(), Error> {
        let record = text(self)?;
        let name = diagram_name(diagram);
        output.store.write(&name, record.as_bytes()).map(|_| ())
    }

    /// What stands for diagram `diagram`.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub(super) fn find(
        output: &Output,
        plan: &Plan,
        diagram: &str,
        check: Check,
    ) -> Result<Found<Self>, Error> {
        find(
            output,
            &diagram_name(diagram),
            &diagram_part(diagram),
            |record| Self::parse(record, plan),
            |commit| std::slice::from_ref(&commit.file),
            check,
        )
    }

    fn parse(record: &[u8], plan: &Plan) -> Result<Self, String> {
        let commit: Self = serde_json::from_slice(record).map_err(|error| error.to_string())?;
        match commit.plan_id == plan.id {
            true => Ok(commit),
            false => Err("it belongs to another sweep".into()),
        }
    }
}

fn diagram_name(diagram: &str) -> String {
    format!("_sweep/commits/bifurcation-{diagram}.json")
}

fn diagram_part(diagram: &str) -> String {
    format!("bifurcation diagram {diagram}")
}

/// What stands for `part`, whose record is called `name`.
fn find<T>(
    output: &Output,
    name: &str,
    part: &str,
    parse: impl Fn(&[u8]) -> Result<T, String>,
    files: impl Fn(&T) -> &[FileEntry],
    check: Check,
) -> Result<Found<T>, Error> {
    let Some(record) = output.store.bytes(name)? else {
        return Ok(Found::Nothing);
    };
    let damaged = |name: &str, reason: String| {
        let path = output.path(name);
        let path = path.display();
        output.warn(format!("`{path}` {reason}: {part} counts as not made"));
        Ok(Found::Damaged)
    };
    let commit = match parse(&record) {
        Ok(commit) => commit,
        Err(reason) => return damaged(name, format!("is damaged ({reason})")),
    };
    for file in files(&commit) {
        if let Some(damage) = damage_of(&output.store, file, check)? {
            return damaged(&file.path, damage.to_string());
        }
    }
    Ok(Found::Made(commit))
}
