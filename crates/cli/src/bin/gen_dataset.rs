//! `gen-dataset`: the main job.

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    if let Some(tried) = cli::try_case::if_asked() {
        return tried;
    }
    cli::finish(cli::gen_dataset::run(&Program::parse().arguments))
}

/// Simulate a sweep of cases and write a labelled dataset
#[derive(Parser)]
#[command(
    name = "gen-dataset",
    version,
    about = "Simulate a sweep of cases and write a labelled dataset"
)]
struct Program {
    #[command(flatten)]
    arguments: cli::gen_dataset::Arguments,
}
