//! `sweep plan`: a dataset is begun.

use crate::choice::one_of;
use crate::gen_dataset::{self, FORMATS};
use crate::output::{hint, warn};
use crate::{Failure, interrupt};
use clap::Args;
use std::path::PathBuf;
use sweep::Sweep;
use sweep::sweep_file::Format;

#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  crosshead sweep plan pipelines/bearing-faults.yaml --out /scratch/faults --shards 100

A sweep that calibrates its machine does so here. The command is safe to repeat; another sweep in
the same place is refused. The shards are of equal size, from `shard_size` of the sweep file or
--shards; each bifurcation diagram is one more shard. The bytes of a dataset depend on that size
and not on the machines that make the shards.

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong.")]
pub struct Arguments {
    /// The sweep file
    sweep: PathBuf,
    /// Folder of the dataset, seen by all machines that make it, or s3://BUCKET/PREFIX
    #[arg(long, value_name = "URL")]
    out: PathBuf,
    /// Number of shards; a few less if the cases do not divide evenly
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    shards: Option<u64>,
    /// Format of the recordings, instead of the sweep's own
    #[arg(long, value_parser = one_of(FORMATS))]
    format: Option<Format>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let sweep = Sweep::read(&arguments.sweep)?;
    let nominal = sweep.nominal()?;
    nominal.check_size()?;
    let cancel = interrupt::flag()?;
    let out = &arguments.out;
    let (claim, plan) = gen_dataset::claim(&sweep, nominal, out, sweep::Existing::Resume, &cancel)?;
    let mut plan = gen_dataset::with_format(plan, arguments.format)?;
    if let Some(shards) = arguments.shards {
        plan = plan.with_shards(shards)?;
    }
    warn(&plan.census().mistakes());
    let output = claim.open(&plan)?;
    warn(&output.take_warnings());
    println!(
        "{}: {} cases, shards 0 to {} ({} of cases, {} bifurcation diagrams)",
        out.display(),
        plan.cases(),
        plan.parts() - 1,
        plan.shards(),
        plan.diagrams.len()
    );
    hint(format_args!(
        "crosshead sweep shard {} --index 0, and so for each shard",
        out.display()
    ));
    Ok(())
}
