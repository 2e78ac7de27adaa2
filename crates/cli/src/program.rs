//! The programs `crosshead` and `gen-dataset`: their verbs, and which is called.

use crate::console::{Console, colour_of_clap};
#[cfg(feature = "serve")]
use crate::serve;
use crate::{
    Failure, calibrate, check, compare, completions, domain_gap, estimate_wear, explain_gap,
    features, gen_dataset, hidden_effects, init,
};
use crate::{finish, man, replay, report, schema, simulate, sweep, try_case, verify};
use clap::{Command, CommandFactory, FromArgMatches, Parser};
use std::ffi::OsString;

/// Help is no wider than this, so that a line is read at once.
pub const WIDEST_HELP: usize = 100;

/// Labelled recordings of reciprocating compressors with worn bearings.
#[derive(Parser)]
#[command(
    name = "crosshead",
    version,
    arg_required_else_help = true,
    max_term_width = WIDEST_HELP
)]
pub struct Crosshead {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    console: Console,
}

verbs! {
    Verb:
    /// Write a commented file to fill in: a machine, a sweep, a bundle, a calibration
    Init(init),
    /// Find all mistakes in files that you have written
    Check(check),
    /// Simulate a sweep of cases and write a labelled dataset (as the program gen-dataset)
    GenDataset(gen_dataset),
    /// Make a dataset in steps, on many machines at once
    Sweep(sweep),
    /// Simulate one run of a machine: signals, p-V cards, rod loads, pictures
    Simulate(simulate),
    /// Compute the features of recordings, measured or simulated
    Features(features),
    /// Compare two recordings, or two datasets: features, waveforms, spectra
    Compare(compare),
    /// Find out whether a classifier can tell simulated windows from measured ones, and by which features
    DomainGap(domain_gap),
    /// Check that the files of a finished dataset are those that were written
    Verify(verify),
    /// Make the HTML page of a dataset: what is in it, examples, spectra, comparisons
    Report(report),
    /// Show the pages of a folder in a browser, live while the folder grows
    #[cfg(feature = "serve")]
    Serve(serve),
    /// Fit a machine's parameters to recordings of it
    Calibrate(calibrate),
    /// Estimate which joints are worn, and how much, from recordings
    EstimateWear(estimate_wear),
    /// Find which effect a model lacks that recordings show, and add it
    ExplainGap(explain_gap),
    /// Hide effects in recordings made here, and count which of them explain-gap finds
    HiddenEffects(hidden_effects),
    /// Simulate the runs of a bundle and report how far they differ from the recordings
    Replay(replay),
    /// Print the JSON Schema of a file, for editors and checks
    Schema(schema),
    /// Print a script that completes verbs and options in a shell
    Completions(completions, commands()),
    /// Write the manual pages
    Man(man, commands()),
}

/// Simulate a sweep of cases and write a labelled dataset
#[derive(Parser)]
#[command(
    name = "gen-dataset",
    version,
    about = "Simulate a sweep of cases and write a labelled dataset",
    max_term_width = WIDEST_HELP
)]
pub struct GenDataset {
    #[command(flatten)]
    arguments: gen_dataset::Arguments,
    #[command(flatten)]
    console: Console,
}

/// What a program does.
pub trait Program: CommandFactory + FromArgMatches {
    /// Does it.
    ///
    /// # Errors
    /// Those of its verb.
    fn run(&self) -> Result<(), Failure>;
}

impl Program for Crosshead {
    fn run(&self) -> Result<(), Failure> {
        self.console.set()?;
        self.verb.run()
    }
}

impl Program for GenDataset {
    fn run(&self) -> Result<(), Failure> {
        self.console.set()?;
        gen_dataset::run(&self.arguments)
    }
}

/// Both programs, `crosshead` first, as clap knows them.
pub fn commands() -> [Command; 2] {
    [Crosshead::command(), GenDataset::command()]
}

/// Does what `arguments` say, the first of which is the program's own name, and gives the exit status.
pub fn main<P: Program>(arguments: Vec<OsString>) -> u8 {
    try_case::if_asked(&arguments).unwrap_or_else(|| finish(parse::<P>(arguments).run()))
}

fn parse<P: Program>(arguments: Vec<OsString>) -> P {
    let command = P::command().color(colour_of_clap(arguments.iter().cloned()));
    let matches = command.get_matches_from(arguments);
    P::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
}
