//! How far a sweep has got.

use super::attempts;
use super::commit::{Commit, DiagramCommit};
use super::output::Output;
use super::parts::Part;
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
    pub failed: u64,
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
        failed: 0,
        complete: output.store.length("manifest.json")?.is_some(),
    };
    let attempts = attempts::counts(output)?;
    for index in 0..plan.parts() {
        let commit = match plan.part(index) {
            Some(Part::Shard(shard)) => {
                Commit::read(output, plan, shard)?.map(|c| (c.cases, c.failed))
            }
            Some(Part::Diagram(diagram)) => {
                let commit = DiagramCommit::read(output, plan, &diagram.name)?;
                commit.map(|_| ([0, 0], Vec::new()))
            }
            None => None,
        };
        match commit {
            Some(([start, end], failed)) => {
                status.cases += end - start;
                status.failed += failed.len() as u64;
            }
            None => {
                status.missing.push(index);
                let count = attempts.get(&index.to_string());
                status.attempts.extend(count.map(|&count| (index, count)));
            }
        }
    }
    Ok(status)
}
