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
use clap::{Args, Subcommand};

/// Arguments of `sweep`.
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

#[derive(Subcommand, Debug)]
enum Step {
    /// Begin a dataset: write what its shards need to know
    Plan(plan::Arguments),
    /// Make one shard; safe to repeat
    Shard(shard::Arguments),
    /// Complete the dataset when all its shards are made
    Finalize(finalize::Arguments),
    /// Show the progress of the dataset
    Status(status::Arguments),
    /// Submit the shards to an engine that runs them on its machines
    Submit(submit::Arguments),
    /// Cancel the submitted jobs
    Cancel(cancel::Arguments),
    /// Add Delta tables to a finished dataset
    ExportDelta(export_delta::Arguments),
}

/// Takes a step.
///
/// # Errors
/// Wrong input, an output that cannot be written, or a dataset that is not complete yet.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.step {
        Step::Plan(arguments) => plan::run(arguments),
        Step::Shard(arguments) => shard::run(arguments),
        Step::Finalize(arguments) => finalize::run(arguments),
        Step::Status(arguments) => status::run(arguments),
        Step::Submit(arguments) => submit::run(arguments),
        Step::Cancel(arguments) => cancel::run(arguments),
        Step::ExportDelta(arguments) => export_delta::run(arguments),
    }
}
