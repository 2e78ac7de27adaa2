//! Progress of a sweep.

use std::fmt::Write;
use std::path::Path;

use recordings::FailedCase;
use serde::Serialize;

use super::attempts::{self, Attended};
use super::check::Check;
use super::fault::Damage;
use super::finalize::Parts;
use super::layout::strays;
use super::output::Output;
use super::parts::scan;
use super::summary::failures;
use crate::ranges::ranges;
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

/// The progress of a sweep with the numbers of its plan, for people and programs.
#[derive(Clone, Debug, Serialize)]
pub struct StatusReport {
    /// Identifier of the plan.
    pub plan_id: String,
    /// Name of the dataset.
    pub name: String,
    /// Whether the dataset has its manifest.
    pub complete: bool,
    /// Shards of the plan, bifurcation diagrams included.
    pub shards: u64,
    /// Those that are finished.
    pub made: u64,
    /// Numbers of the others, as ranges.
    pub missing: String,
    /// Cases of the plan.
    pub cases: u64,
    /// Cases in finished shards.
    pub cases_made: u64,
    /// How many of them failed.
    pub cases_failed: usize,
    /// Which of them failed.
    pub failed: Vec<FailedCase>,
    attempts: Vec<Attempts>,
    /// The jobs that are under way.
    pub jobs: Vec<String>,
}

/// The processes at a shard.
#[derive(Clone, Copy, Debug, Serialize)]
struct Attempts {
    shard: u64,
    attempts: u64,
    at_work: u64,
    ended: u64,
}

impl Status {
    /// With the numbers of the plan, and the jobs that are under way.
    pub fn report(&self, plan: &Plan, jobs: Vec<String>) -> StatusReport {
        let attempts = self.attempts.iter().map(|(shard, at)| Attempts {
            shard: *shard,
            attempts: at.at_work + at.ended,
            at_work: at.at_work,
            ended: at.ended,
        });
        StatusReport {
            plan_id: plan.id.clone(),
            name: plan.name.clone(),
            complete: self.complete,
            shards: plan.parts(),
            made: plan.parts() - self.missing.len() as u64,
            missing: ranges(&self.missing),
            cases: plan.cases(),
            cases_made: self.cases,
            cases_failed: self.failed.len(),
            failed: self.failed.clone(),
            attempts: attempts.collect(),
            jobs,
        }
    }
}

impl StatusReport {
    /// A few lines on the dataset at `url`.
    pub fn text(&self, url: &Path) -> String {
        let complete = match self.complete {
            true => "complete",
            false => "not finalized",
        };
        let mut text = format!(
            "{}: {complete}\nshards: {} of {} are made\ncases: {} of {}, {} failed\n",
            url.display(),
            self.made,
            self.shards,
            self.cases_made,
            self.cases,
            self.cases_failed
        );
        let mut line = |words: String| writeln!(text, "{words}");
        // A string takes all that is written to it.
        let _ = failures(&self.failed, self.cases, url).map(&mut line);
        if !self.missing.is_empty() {
            let _ = line(format!("missing: {}", self.missing));
        }
        for at in &self.attempts {
            let (shard, at_work, ended) = (at.shard, at.at_work, at.ended);
            let _ = line(format!(
                "shard {shard}: {at_work} processes at work, {ended} ended without a result"
            ));
        }
        for job in &self.jobs {
            let _ = line(format!("Slurm job {job}"));
        }
        text
    }
}
