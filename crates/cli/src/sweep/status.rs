//! `sweep status`: how far a dataset has got.

use crate::Failure;
use crate::gen_dataset;
use crate::output::hint;
use clap::Args;
use recordings::FailedCase;
use serde::Serialize;
use std::path::PathBuf;
use sweep::dataset::{Output, status};
use sweep::engines::slurm::Jobs;
use sweep::ranges::ranges;

/// Arguments of `sweep status`.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  crosshead sweep status /scratch/faults

Reads the records and the lengths of files; with --verify also the files, which takes long.
A damaged shard counts as not made, and gives a warning.")]
pub struct Arguments {
    /// The dataset, as it was planned
    url: PathBuf,
    /// Folder of the jobs' scripts, as it was given to `sweep submit`
    #[arg(long, value_name = "DIR")]
    scripts: Option<PathBuf>,
    /// Compare every file with its checksum
    #[arg(long)]
    verify: bool,
    /// As JSON, for programs
    #[arg(long)]
    json: bool,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Status<'a> {
    plan_id: &'a str,
    name: &'a str,
    complete: bool,
    shards: u64,
    made: u64,
    missing: String,
    cases: u64,
    cases_made: u64,
    cases_failed: usize,
    failed: &'a [FailedCase],
    attempts: Vec<Attempts>,
    jobs: Vec<String>,
}

/// The processes at a shard.
#[derive(Serialize)]
struct Attempts {
    shard: u64,
    attempts: u64,
    at_work: u64,
    ended: u64,
}

/// Prints how far the dataset has got.
///
/// # Errors
/// Nothing planned, or records that cannot be read.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (output, plan) = Output::open_read_only(&arguments.url)?;
    let found = status(&output, &plan, arguments.verify)?;
    gen_dataset::warn(&output.take_warnings());
    let jobs = Jobs::new(&arguments.url, arguments.scripts.as_deref());
    let jobs = jobs.map_or_else(|_| Vec::new(), |jobs| jobs.under_way());
    let made = plan.parts() - found.missing.len() as u64;
    if arguments.json {
        let attempts = found.attempts.iter().map(|(shard, at)| Attempts {
            shard: *shard,
            attempts: at.at_work + at.ended,
            at_work: at.at_work,
            ended: at.ended,
        });
        let status = Status {
            plan_id: &plan.id,
            name: &plan.name,
            complete: found.complete,
            shards: plan.parts(),
            made,
            missing: ranges(&found.missing),
            cases: plan.cases(),
            cases_made: found.cases,
            cases_failed: found.failed.len(),
            failed: &found.failed,
            attempts: attempts.collect(),
            jobs,
        };
        let text = serde_json::to_string_pretty(&status).map_err(Failure::work)?;
        println!("{text}");
        return Ok(());
    }
    let complete = match found.complete {
        true => "complete",
        false => "not finalized",
    };
    println!("{}: {complete}", arguments.url.display());
    println!("shards: {made} of {} are made", plan.parts());
    println!(
        "cases: {} of {}, {} failed",
        found.cases,
        plan.cases(),
        found.failed.len()
    );
    if let Some(text) = gen_dataset::failures(&found.failed, plan.cases(), &arguments.url) {
        println!("{text}");
    }
    if !found.missing.is_empty() {
        println!("missing: {}", ranges(&found.missing));
    }
    for (shard, at) in found.attempts {
        let (at_work, ended) = (at.at_work, at.ended);
        println!("shard {shard}: {at_work} processes at work, {ended} ended without a result");
    }
    for job in jobs {
        println!("Slurm job {job}");
    }
    let url = arguments.url.display();
    match (found.complete, found.missing.is_empty()) {
        (true, _) => hint(format_args!("crosshead report {url}")),
        (false, true) => hint(format_args!("crosshead sweep finalize {url}")),
        (false, false) => hint(format_args!(
            "crosshead sweep shard {url} --index {}",
            found.missing[0]
        )),
    }
    Ok(())
}
