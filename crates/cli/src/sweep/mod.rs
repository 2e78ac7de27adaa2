//! `sweep`: `gen-dataset` in steps, which any number of machines take together. The sweep is
//! planned once, its shards are made anywhere and in any order, and the dataset is finalized.

mod cancel;
mod export_delta;
mod finalize;
mod plan;
mod shard;
mod status;
mod submit;

use crate::Failure;
use clap::Args;

#[derive(Args, Debug)]
#[command(after_help = "\
Example, with four processes in the place of four machines:
  crosshead sweep plan pipelines/paper2.yaml --out paper2 --shards 4
  for k in 0 1 2 3; do crosshead sweep shard paper2 --index $k & done; wait
  crosshead sweep finalize paper2

A URL is a folder that all machines see, or s3://BUCKET/PREFIX.")]
pub struct Arguments {
    #[command(subcommand)]
    step: Step,
}

verbs! {
    Step:
    /// Begin a dataset: write what its shards need to know
    Plan(plan),
    /// Make one shard; safe to repeat
    Shard(shard),
    /// Complete the dataset when all its shards are made
    Finalize(finalize),
    /// Show the progress of the dataset
    Status(status),
    /// Submit the shards to an engine that runs them on its machines
    Submit(submit),
    /// Cancel the submitted jobs
    Cancel(cancel),
    /// Add Delta tables to a finished dataset
    ExportDelta(export_delta),
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.step.run()
}
