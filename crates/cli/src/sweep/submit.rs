//! `sweep submit`: an engine is handed the shards.

use crate::Failure;
use crate::output::hint;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use sweep::dataset::{Output, status};
use sweep::engines::slurm::Jobs;

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead sweep submit /scratch/faults --engine slurm -- --partition=long --cpus-per-task=8
  crosshead sweep submit s3://bucket/faults --engine slurm --scripts /scratch/jobs

Writes batch scripts and submits the missing shards as job arrays. One more job runs when they
have ended, with or without success. It completes the dataset, or submits the shards that are
still missing, up to three times in all. Each task simulates on as many threads as it has
processors (--cpus-per-task, else one). The jobs get the environment of this command, including
AWS_* for a bucket. The program must have the same path on all machines.

Exit status: 0 submitted; 1 the work failed; 2 the input or the arguments are wrong.")]
pub struct Arguments {
    /// The dataset, as it was planned
    url: PathBuf,
    /// What runs the shards
    #[arg(long, value_enum)]
    engine: Engine,
    /// Folder of the jobs' scripts and logs, which all machines see [default: URL/_sweep/slurm where URL is a folder]
    #[arg(long, value_name = "DIR")]
    scripts: Option<PathBuf>,
    /// Most tasks of one array; the default of MaxArraySize in Slurm is 1001
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

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let jobs = Jobs::new(&arguments.url, arguments.scripts.as_deref())?;
    let (output, plan) = Output::open_read_only(&arguments.url)?;
    let missing = status(&output, &plan, false)?.missing;
    let submitted = match arguments.engine {
        Engine::Slurm => jobs.submit(&plan.name, &missing, arguments.array_size, &arguments.flags),
    };
    println!("{}", submitted?);
    hint(format_args!(
        "crosshead sweep status {}",
        arguments.url.display()
    ));
    Ok(())
}
