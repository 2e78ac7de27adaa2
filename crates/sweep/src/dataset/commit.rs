//! What says that a shard is finished: `_sweep/commits/K.json`, written once, after its files; and
//! the same for bifurcation diagrams.
//!
//! A shard that is run twice (after a crash, or by two machines at once) writes the same files
//! under the same names; its second commit finds the first and must agree with it. So no case is
//! ever there twice, and a difference never passes unseen.

use std::collections::BTreeMap;

use recordings::{CaseWarning, FailedCase, FileEntry};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::output::Output;
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

impl Commit {
    /// Compares it with the record of an attempt that finished before, if there is one.
    ///
    /// # Errors
    /// Where that wrote other files.
    pub(super) fn compare(&self, output: &Output, plan: &Plan) -> Result<bool, Error> {
        if Self::read(output, plan, self.shard)?.is_none() {
            return Ok(false);
        }
        self.write(output)?;
        Ok(true)
    }

    /// Says that the shard is finished.
    ///
    /// # Errors
    /// Where it was finished before with other files, or the record cannot be written.
    pub(super) fn write(&self, output: &Output) -> Result<(), Error> {
        write(
            output,
            &name(self.shard),
            &format!("shard {}", self.shard),
            self,
        )
    }

    /// The record of a shard, if it is finished and its files are there in full length.
    ///
    /// # Errors
    /// Where the record is damaged or of another plan.
    pub(super) fn read(output: &Output, plan: &Plan, shard: u64) -> Result<Option<Self>, Error> {
        let commit = read(output, &name(shard), |c: &Self| c.plan_id == plan.id)?;
        let Some(commit) = commit else {
            return Ok(None);
        };
        if !commit.is_of(plan, shard) {
            return Err(Error::Damaged {
                path: output.path(&name(shard)),
                reason: "its cases, rows or failures are not those of the shard".into(),
            });
        }
        for file in &commit.files {
            if !is_whole(output, file)? {
                return Ok(None);
            }
        }
        Ok(Some(commit))
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

fn name(shard: u64) -> String {
    format!("_sweep/commits/{shard}.json")
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
    /// As [`Commit::write`].
    pub(super) fn write(&self, output: &Output, diagram: &str) -> Result<(), Error> {
        let part = format!("diagram {diagram}");
        write(output, &diagram_name(diagram), &part, self)
    }

    /// The record of diagram `diagram`, if it is finished and its file is there in full length.
    ///
    /// # Errors
    /// As [`Commit::read`].
    pub(super) fn read(output: &Output, plan: &Plan, diagram: &str) -> Result<Option<Self>, Error> {
        let name = diagram_name(diagram);
        match read(output, &name, |c: &Self| c.plan_id == plan.id)? {
            Some(commit) if is_whole(output, &commit.file)? => Ok(Some(commit)),
            _ => Ok(None),
        }
    }
}

fn diagram_name(diagram: &str) -> String {
    format!("_sweep/commits/bifurcation-{diagram}.json")
}

/// Writes the record of `part`, or compares it with the one that is there.
fn write(output: &Output, name: &str, part: &str, commit: &impl Serialize) -> Result<(), Error> {
    let now = text(commit)?;
    let before = output.store.create_only(name, &now)?;
    match before.filter(|before| *before != now) {
        None => Ok(()),
        Some(before) => Err(Error::NotDeterministic {
            part: part.to_owned(),
            first: checksum(&before),
            second: checksum(&now),
        }),
    }
}

/// The record `name`, if there is one; `ours` tells that it belongs to this plan.
fn read<T: DeserializeOwned>(
    output: &Output,
    name: &str,
    ours: impl Fn(&T) -> bool,
) -> Result<Option<T>, Error> {
    let damaged = |reason| Error::Damaged {
        path: output.path(name),
        reason,
    };
    let Some(text) = output.store.read(name)? else {
        return Ok(None);
    };
    let commit: T = serde_json::from_str(&text).map_err(|e| damaged(e.to_string()))?;
    if !ours(&commit) {
        return Err(damaged("it belongs to another sweep".into()));
    }
    Ok(Some(commit))
}

/// Whether a file is there in full length.
fn is_whole(output: &Output, file: &FileEntry) -> Result<bool, Error> {
    Ok(output.store.length(&file.path)? == Some(file.bytes))
}

/// A record as it is written.
pub(super) fn text(record: &impl Serialize) -> Result<String, Error> {
    let json = serde_json::to_string_pretty(record).map_err(|e| {
        let message = e.to_string();
        recordings::Error::Write(std::io::Error::other(message))
    })?;
    Ok(json + "\n")
}

fn checksum(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
