//! `crosshead`: everything beside the main job, which it has as a subcommand too.

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Labelled recordings of reciprocating compressors with worn bearings.
#[derive(Parser)]
#[command(name = "crosshead", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Write a commented file to fill in: a machine, a sweep, a bundle of recordings, a calibration
    Init(cli::init::Arguments),
    /// Find all mistakes in files that you have written
    Check(cli::check::Arguments),
    /// Simulate a sweep of cases and write a labelled dataset (the same as the program gen-dataset)
    GenDataset(cli::gen_dataset::Arguments),
    /// Make a dataset in steps, on many machines at once
    Sweep(cli::sweep::Arguments),
    /// Simulate one run of a machine: signals and a picture
    Simulate(cli::simulate::Arguments),
    /// Compute the features of recordings, measured or simulated
    Features(cli::features::Arguments),
    /// Check that the files of a finished dataset are those that were written
    Verify(cli::verify::Arguments),
    /// Make the HTML page of a dataset: what is in it, examples, spectra, comparisons
    Report(cli::report::Arguments),
    /// Fit a machine's parameters to recordings of it
    Calibrate(cli::calibrate::Arguments),
    /// Find which effect a model lacks that recordings show, and add it
    ExplainGap(cli::explain_gap::Arguments),
    /// Hide effects in recordings made here, and count which of them explain-gap finds
    HiddenEffects(cli::hidden_effects::Arguments),
    /// Simulate the runs of a bundle and report how far they differ from the recordings
    Replay(cli::replay::Arguments),
    /// Print the JSON Schema of a file, for editors and checks
    Schema(cli::schema::Arguments),
}

fn main() -> ExitCode {
    if let Some(tried) = cli::try_case::if_asked() {
        return tried;
    }
    cli::finish(match Arguments::parse().verb {
        Verb::Init(arguments) => cli::init::run(&arguments),
        Verb::Check(arguments) => cli::check::run(&arguments),
        Verb::GenDataset(arguments) => cli::gen_dataset::run(&arguments),
        Verb::Sweep(arguments) => cli::sweep::run(&arguments),
        Verb::Simulate(arguments) => cli::simulate::run(&arguments),
        Verb::Features(arguments) => cli::features::run(&arguments),
        Verb::Verify(arguments) => cli::verify::run(&arguments),
        Verb::Report(arguments) => cli::report::run(&arguments),
        Verb::Calibrate(arguments) => cli::calibrate::run(&arguments),
        Verb::ExplainGap(arguments) => cli::explain_gap::run(&arguments),
        Verb::HiddenEffects(arguments) => cli::hidden_effects::run(&arguments),
        Verb::Replay(arguments) => cli::replay::run(&arguments),
        Verb::Schema(arguments) => cli::schema::run(&arguments),
    })
}
