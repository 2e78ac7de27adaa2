//! How far a sweep has got.

use recordings::FailedCase;

use super::attempts::{self, Attended};
use super::commit::Check;
use super::output::Output;
use super::parts::{Made, scan};
use crate::{Error, Plan};

/// How far a sweep has got.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Status {
    /// Numbers of the shards that are not finished; bifurcation diagrams follow the shards.
    pub missing: Vec<u64>,
    /// The processes at those of them that have any.
    pub attempts: Vec<(u64, Attended)>,
    /// Cases in finished shards.
    pub cases: u64,
    /// Those of them that failed.
    pub failed: Vec<FailedCase>,
    /// Whether the dataset has its manifest, and so is complete.
    pub complete: bool,
}

/// How far the sweep has got. Damaged records count as not made; [`Output::take_warnings`] names them.
///
/// # Errors
/// Where the storage cannot be read.
pub fn status(output: &Output, plan: &Plan) -> Result<Status, Error> {
    let mut status = Status {
        missing: Vec::new(),
        attempts: Vec::new(),
        cases: 0,
        failed: Vec::new(),
        complete: output.store.length("manifest.json")?.is_some(),
    };
    scan(
        plan,
        output,
        0..plan.parts(),
        Check::Lengths,
        |index, made| {
            match made {
                Some(Made::Shard(commit)) => {
                    let [start, end] = commit.cases;
                    status.cases += end - start;
                    status.failed.extend(commit.failed);
                }
                Some(Made::Diagram(_)) => {}
                None => status.missing.push(index),
            }
            Ok(())
        },
    )?;
    let is_missing = |shard| status.missing.binary_search(&shard).is_ok();
    status.attempts = attempts::counts(output, is_missing)?.into_iter().collect();
    Ok(status)
}
