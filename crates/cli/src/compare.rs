//! `crosshead compare`: two recordings, or two datasets, side by side.

use crate::progress::Progress;
use crate::reading::Reading;
use crate::result_format::{ResultFiles, ResultFormat};
use crate::{Failure, console};
use ::features::recorded::{Error, Said, Table, inputs};
use ::report::{comparison_page, summary};
use clap::Args;
use std::path::{Path, PathBuf};
use sweep::comparison::compare;

#[derive(Args, Debug)]
#[command(after_help = "\
A and B are recordings as crosshead features reads them: files, bundles, datasets or folders of
crosshead simulate. Of each the features are averaged over its windows. comparison.json has them
side by side, with difference and ratio; comparison.html has them as a table, and the channels of
both over the crank angle and over frequency.

Examples:
  crosshead compare healthy-run worn-run --out compared
  crosshead compare january.csv june.csv --unit m/s^2 --speed '500 rpm' --out compared
  crosshead compare datasets/measured datasets/simulated --out compared

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong.")]
pub struct Arguments {
    /// The first
    a: PathBuf,
    /// The second
    b: PathBuf,
    #[command(flatten)]
    reading: Reading,
    /// Folder to write into: comparison.json, comparison.html
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Replace a comparison that is there
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    format: ResultFormat,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let files = ResultFiles::new(&arguments.out, "comparison", arguments.overwrite)?;
    let (said, length) = (arguments.reading.said()?, arguments.reading.window()?);
    let pool = console::pool()?;
    let paths = [arguments.a.as_path(), arguments.b.as_path()];
    share_a_channel(paths, &said)?;
    let comparison = Progress::during("features of both", || compare(paths, &said, length, &pool))?;
    let page = comparison_page::render(&comparison)?;
    let lines = summary::comparison(&comparison);
    files.write(&comparison, &page, arguments.format, &lines)
}

/// Refuses recordings that have no channel in common.
fn share_a_channel(paths: [&Path; 2], said: &Said) -> Result<(), Failure> {
    let [a, b] = paths.map(|path| channels(path, said));
    let (a, b) = (a?, b?);
    if a.iter().any(|channel| b.contains(channel)) {
        return Ok(());
    }
    let [first, second] = paths.map(Path::display);
    let [a, b] = [a, b].map(|channels| channels.join(", "));
    Err(Failure::input(format!(
        "the recordings have no channel in common, by name and unit; give what is the same one name, in recordings.yaml or \
         in the heading\n  {first}: {a}\n  {second}: {b}"
    )))
}

/// The channels that a path has, each as `name [unit]`.
fn channels(path: &Path, said: &Said) -> Result<Vec<String>, Error> {
    let inputs = inputs(&[path.to_owned()], said)?;
    let table = Table::new(&inputs, said)?;
    let shown = |(name, unit): (&str, &str)| match unit {
        "" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    };
    Ok(table.channels().into_iter().map(shown).collect())
}
