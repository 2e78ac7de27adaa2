//! `crosshead check`: all mistakes of files that people write, at once.

use crate::Failure;
use crate::choice::KINDS;
use crate::result_format::ResultFormat;
use ::features::recorded::counted;
use clap::Args;
use input::file_kind::{Checked, check_file};
use std::collections::BTreeSet;
use std::path::PathBuf;

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead check machine.yaml sweep.yaml
  crosshead check recordings/

Every mistake is a line on standard error: file, line, key, what was found, what was expected. The
keys of a file show its kind. Nothing is written and nothing is simulated.

Exit status: 0 no mistakes; 1 there are some; 2 a file cannot be read.")]
pub struct Arguments {
    /// machine.yaml, sweep.yaml, calibration.yaml, hidden-effects.yaml, recordings.yaml, or the folder of a bundle
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    format: ResultFormat,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut all: Vec<Checked> = Vec::new();
    let mut unreadable = Vec::new();
    for path in &arguments.files {
        match check_file(path, &KINDS) {
            Ok(checked) => {
                let mistakes = checked.mistakes.iter();
                mistakes.for_each(|mistake| eprintln!("error: {mistake}"));
                all.push(checked);
            }
            Err(error) => unreadable.push(error),
        }
    }
    let summary: String = all.iter().map(ToString::to_string).collect();
    if !all.is_empty() {
        arguments.format.print(&all, summary)?;
    }
    if let Some(error) = input::Error::all(unreadable) {
        return Err(error.into());
    }
    let mistakes = || all.iter().flat_map(|checked| &checked.mistakes);
    let files: BTreeSet<&String> = mistakes().map(|mistake| &mistake.file).collect();
    match mistakes().count() {
        0 => Ok(()),
        count => Err(Failure::work(format!(
            "{} in {}",
            counted(count as u64, "mistake"),
            counted(files.len() as u64, "file")
        ))),
    }
}
