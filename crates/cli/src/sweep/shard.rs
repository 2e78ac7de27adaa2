//! `sweep shard`: one shard is made.

use crate::gen_dataset::{Bar, options};
use crate::output::hint;
use crate::{Failure, interrupt};
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;
use sweep::dataset::{Existing, Output, run_part};
use sweep::engines::task;
use sweep::{Error, simulate_cases};

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead sweep shard /scratch/faults --index 17
  sbatch --array=0-99 --wrap 'crosshead sweep shard /scratch/faults --threads 1'

Without --index the number is taken from the first of these variables that has one:
SLURM_ARRAY_TASK_ID, PBS_ARRAY_INDEX, PBS_ARRAYID, LSB_JOBINDEX, SGE_TASK_ID, JOB_COMPLETION_INDEX.
Shards count from 0; LSF and Grid Engine count tasks from 1, so that their task 1 is shard 0.

A finished shard stays as it is. Two processes may make the same shard at once.

Exit status: 0 the shard is made; 1 the work failed; 2 the input or the arguments are wrong;
130 interrupted.")]
pub struct Arguments {
    /// The dataset, as it was planned
    url: PathBuf,
    /// Number of the shard, from 0 [default: the engine's variable]
    #[arg(long)]
    index: Option<u64>,
    /// Added to the number, for arrays that cannot count far enough
    #[arg(long, default_value_t = 0, value_name = "NUMBER")]
    offset: u64,
    /// Make the shard again if cases of it failed
    #[arg(long)]
    retry_failed: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let index = match arguments.index {
        Some(index) => index,
        None => task::index(|name| std::env::var(name).ok())?,
    };
    let index = index.saturating_add(arguments.offset);
    let (output, plan) = Output::join(&arguments.url)?;
    let cancel = interrupt::flag()?;
    let options = options(Existing::Resume, arguments.retry_failed, &cancel);
    let started = Instant::now();
    let mut bar = Bar::default();
    let made = run_part(&plan, &output, index, &options, &simulate_cases, &mut bar);
    drop(bar);
    let made = made.map_err(|error| match error {
        Error::Cancelled { .. } | Error::DiagramsCancelled { .. } => Failure::interrupted(format!(
            "stopped; shard {index} is not made, and the same command begins it again"
        )),
        error => error.into(),
    })?;
    if !made {
        println!("shard {index}: was made before");
        return Ok(());
    }
    let seconds = started.elapsed().as_secs_f64();
    println!("shard {index}: made in {seconds:.1} s");
    hint(format_args!(
        "crosshead sweep finalize {}, once all shards are made",
        arguments.url.display()
    ));
    Ok(())
}
