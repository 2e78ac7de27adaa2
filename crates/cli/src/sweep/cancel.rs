//! `sweep cancel`: what was submitted is taken back.

use super::of_engine;
use crate::Failure;
use clap::Args;
use std::path::PathBuf;
use sweep::engines::slurm::Jobs;

/// Arguments of `sweep cancel`.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  crosshead sweep cancel /scratch/faults

Shards that are made stay; `sweep submit` goes on from there.")]
pub struct Arguments {
    /// The dataset
    url: PathBuf,
    /// Folder of the jobs' scripts, as it was given to `sweep submit`
    #[arg(long, value_name = "DIR")]
    scripts: Option<PathBuf>,
}

/// Cancels the jobs.
///
/// # Errors
/// Nothing submitted, or an engine that refuses.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let jobs = Jobs::of(&arguments.url, arguments.scripts.as_deref());
    let cancelled = jobs.and_then(|jobs| jobs.cancel()).map_err(of_engine)?;
    println!("cancelled: {cancelled}");
    Ok(())
}
