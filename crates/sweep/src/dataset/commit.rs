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
use sha2::{Digest, Sha256};

use super::output::Output;
use super::store::Store;
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

/// How much of the files of a record is compared with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Check {
    /// Their lengths.
    Lengths,
    /// Their checksums: everything is read.
    Sums,
    /// Checksums in a folder. A bucket keeps checksums of its own, and reading it back takes as long
    /// as writing it did: their lengths there.
    Resume,
}

/// What stands for a shard or a diagram.
pub(super) enum Found<T> {
    /// No record.
    Nothing,
    /// A record that says nothing, or files that are not those of the record. It was told.
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

    /// Writes the record unless one stands there for this shard, which is then handed back.
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
        if let Some(fault) = fault(&output.store, file, check)? {
            return damaged(&file.path, fault.to_string());
        }
    }
    Ok(Found::Made(commit))
}

/// What is wrong with a file, if anything is.
pub(super) fn fault(
    store: &Store,
    file: &FileEntry,
    check: Check,
) -> Result<Option<Damage>, Error> {
    let expected = file.bytes;
    match store.length(&file.path)? {
        None => return Ok(Some(Damage::Missing)),
        Some(found) if found != expected => return Ok(Some(Damage::Length { found, expected })),
        Some(_) => {}
    }
    if check == Check::Lengths || check == Check::Resume && store.folder().is_none() {
        return Ok(None);
    }
    let found = store.record(&file.path)?;
    let is_same = found.is_some_and(|found| found.sha256 == file.sha256);
    Ok((!is_same).then_some(Damage::Content))
}

/// What is wrong with a file of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Damage {
    /// It is not there.
    #[error("is missing")]
    Missing,
    /// It is shorter or longer.
    #[error("has {found} bytes instead of {expected}")]
    Length {
        /// Its length in bytes.
        found: u64,
        /// The length that was written.
        expected: u64,
    },
    /// Its content is not what was written.
    #[error("has another checksum than when it was written")]
    Content,
    /// A table with other rows than the manifest says.
    #[error("has {found} rows instead of {expected}")]
    Rows {
        /// Its rows.
        found: u64,
        /// The rows that the manifest says.
        expected: u64,
    },
    /// A table whose footer cannot be read.
    #[error("is no Parquet file")]
    Table,
    /// No record has it.
    #[error("is in no record of this dataset, and readers of its folder read it too")]
    Extra,
    /// `SHA256SUMS` is not that of the manifest: one of them was changed.
    #[error("does not agree with manifest.json: one of the two was changed")]
    Sums,
    /// The counts of the manifest contradict its files or failures.
    #[error("its counts are not those of its files and failures")]
    Counts,
    /// The manifest has a file twice.
    #[error("has a file twice")]
    Twice,
    /// The manifest names a file outside of the dataset.
    #[error("lies outside of the dataset and is not read")]
    Outside,
}

/// A record as it is written.
pub(super) fn text(record: &impl Serialize) -> Result<String, Error> {
    Ok(serde_json::to_string_pretty(record).map_err(unwritable)? + "\n")
}

/// A record on one line, without the line's end.
pub(super) fn line(record: &impl Serialize) -> Result<String, Error> {
    Ok(serde_json::to_string(record).map_err(unwritable)?)
}

fn unwritable(error: serde_json::Error) -> recordings::Error {
    recordings::Error::Write(std::io::Error::other(error.to_string()))
}

/// SHA-256 of a text, in hexadecimal.
pub(super) fn checksum(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
