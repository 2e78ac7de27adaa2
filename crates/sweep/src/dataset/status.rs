//! Progress of a sweep.

use recordings::FailedCase;

use super::attempts::{self, Attended};
use super::check::Check;
use super::fault::Damage;
use super::finalize::Parts;
use super::layout::strays;
use super::output::Output;
use super::parts::scan;
use crate::{Error, Plan};

/// The progress of a sweep.
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
    /// Whether the dataset has its manifest, which agrees with the records, and so is complete.
    pub complete: bool,
}

/// The progress of the sweep. Damaged records and files count as not made; they, and files of no shard
/// of this sweep, are named by [`Output::take_warnings`]. Of files the lengths are compared, and with
/// `verify` the checksums, for which everything is read.
///
/// # Errors
/// Errors of a storage that cannot be read.
pub fn status(output: &Output, plan: &Plan, verify: bool) -> Result<Status, Error> {
    let check = match verify {
        true => Check::Sums,
        false => Check::Lengths,
    };
    let mut parts = Parts::new(plan);
    scan(plan, output, 0..plan.parts(), check, |index, made| {
        parts.add(index, made);
        Ok(())
    })?;
    for path in strays(&output.store, |path| plan.names(path))? {
        output.warn(format!(
            "`{}` {}",
            output.path(&path).display(),
            Damage::Extra
        ));
    }
    let missing = parts.missing.clone();
    let is_missing = |shard| missing.binary_search(&shard).is_ok();
    let attempts = attempts::counts(output, is_missing)?.into_iter().collect();
    Ok(Status {
        attempts,
        cases: parts.cases,
        failed: parts.failed.clone(),
        complete: missing.is_empty() && parts.complete(output, plan)?.is_written(output)?,
        missing,
    })
}
