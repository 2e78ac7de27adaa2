//! The whole sweep in one process: its shards, its bifurcation diagrams, and the files that complete it.

use std::path::Path;

use recordings::Manifest;

use super::check::Check;
use super::claim::Claim;
use super::diagrams::run_diagrams;
use super::finalize::finalize;
use super::options::Options;
use super::parts::scan;
use super::progress::Progress;
use super::recording::Runner;
use super::run_shards::{cases_of, run_shards};
use crate::{Error, Plan};

/// Runs the sweep and writes its dataset to the folder `root`.
///
/// The bytes depend on the plan alone: not on the threads, nor on interruptions.
///
/// # Errors
/// - [`Error::TooManyCases`] for a sweep that is too large;
/// - those of [`Claim::new`] and [`Claim::open`] for a folder that cannot be used;
/// - [`Error::Cancelled`] or [`Error::DiagramsCancelled`] if it is stopped;
/// - [`Error::NotDeterministic`] if a shard has other bytes than before;
/// - errors of files that cannot be read or written.
///
/// Failed cases are no error: they are in the manifest.
pub fn generate(
    plan: &Plan,
    root: &Path,
    options: &Options,
    runner: &Runner,
    progress: &mut dyn Progress,
) -> Result<Manifest, Error> {
    plan.check_size()?;
    let claim = Claim::new(root, options.existing)?;
    generate_in(claim, plan, options, runner, progress)
}

/// As [`generate`], in a folder that is locked already.
///
/// # Errors
/// As [`generate`].
pub fn generate_in(
    claim: Claim,
    plan: &Plan,
    options: &Options,
    runner: &Runner,
    progress: &mut dyn Progress,
) -> Result<Manifest, Error> {
    plan.check_size()?;
    let output = claim.open(plan)?;
    let mut pending = Vec::new();
    scan(
        plan,
        &output,
        0..plan.shards(),
        Check::Resume,
        |shard, made| {
            let finished = made.is_some_and(|made| made.is_finished(options));
            pending.extend((!finished).then_some(shard));
            Ok(())
        },
    )?;
    output
        .take_warnings()
        .iter()
        .for_each(|text| progress.warning(text));
    let unfinished = cases_of(plan, &pending);
    progress.begins(plan.cases(), plan.cases() - unfinished);
    output.logged("gen-dataset", || {
        run_shards(plan, &output, &pending, options, runner, progress)?;
        run_diagrams(plan, &output, options, progress)?;
        finalize(&output, plan)
    })
}
