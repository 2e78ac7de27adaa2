//! `sweep submit`: an engine is handed the shards.

use super::slurm;
use crate::Failure;
use crate::gen_dataset;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use sweep::dataset::{Output, status};

/// Arguments of `sweep submit`.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  crosshead sweep submit /scratch/faults --engine slurm -- --partition=long --cpus-per-task=8

Writes batch scripts to URL/_sweep/slurm, submits the shards that are missing as job arrays, and a job
that completes the dataset when they have ended, however they ended. That job submits again what is
still missing, up to three times in all. Each task simulates on as many threads as it has processors
(--cpus-per-task, else one). The program must stand at the same place on all machines.

Exit status: 0 submitted; 1 the work failed; 2 the input or the arguments are wrong.")]
pub struct Arguments {
    /// The folder of the dataset, as it was planned
    url: PathBuf,
    /// What runs the shards
    #[arg(long, value_enum)]
    engine: Engine,
    /// Most tasks of one array; MaxArraySize of the site is 1001 where nobody changed it
    #[arg(long, default_value_t = 1001, value_parser = clap::value_parser!(u64).range(1..), value_name = "TASKS")]
    array_size: u64,
    /// Flags for sbatch
    #[arg(last = true)]
    flags: Vec<String>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Engine {
    /// Job arrays of Slurm
    Slurm,
}

/// Submits what is missing.
///
/// # Errors
/// Nothing planned, jobs that are under way already, or an engine that refuses.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.url.starts_with("s3:") {
        return Err(Failure::input(format!(
            "{}: scripts and logs of the jobs need a folder; for object storage, submit \
             `crosshead sweep shard {}` as an array",
            arguments.url.display(),
            arguments.url.display()
        )));
    }
    let (output, plan) = Output::look(&arguments.url).map_err(gen_dataset::failed)?;
    let missing = status(&output, &plan).map_err(gen_dataset::failed)?.missing;
    match arguments.engine {
        Engine::Slurm => slurm::submit(
            &arguments.url,
            &plan.name,
            &missing,
            arguments.array_size,
            &arguments.flags,
        ),
    }
}
