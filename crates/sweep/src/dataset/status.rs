//! How far a sweep has got.

use recordings::FailedCase;

use super::attempts;
use super::output::Output;
use super::parts::{Made, scan};
use crate::{Error, Plan};

/// How far a sweep has got.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Status {
    /// Numbers of the shards that are not finished; bifurcation diagrams follow the shards.
    pub missing: Vec<u64>,
    /// Those of them that a process is at work on, or was when it ended without a word, and how
    /// many such processes there are.
    pub attempts: Vec<(u64, u64)>,
    /// Cases in finished shards.
    pub cases: u64,
    /// Those of them that failed.
    pub failed: Vec<FailedCase>,
    /// Whether the dataset has its manifest, and so is complete.
    pub complete: bool,
}

/// How far the sweep has got.
///
/// # Errors
/// Where a record cannot be read.
pub fn status(output: &Output, plan: &Plan) -> Result<Status, Error> {
    let mut status = Status {
        missing: Vec::new(),
        attempts: Vec::new(),
        cases: 0,
        failed: Vec::new(),
        complete: output.store.length("manifest.json")?.is_some(),
    };
    let attempts = attempts::counts(output)?;
    scan(plan, output, 0..plan.parts(), |index, made| {
        match made {
            Some(Made::Shard(commit)) => {
                let [start, end] = commit.cases;
                status.cases += end - start;
                status.failed.extend(commit.failed);
            }
            Some(Made::Diagram(_)) => {}
            None => {
                status.missing.push(index);
                let count = attempts.get(&index.to_string());
                status.attempts.extend(count.map(|&count| (index, count)));
            }
        }
        Ok(())
    })?;
    Ok(status)
}
