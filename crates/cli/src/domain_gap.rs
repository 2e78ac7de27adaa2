//! `crosshead domain-gap`: the simulated windows of a dataset beside measured ones.

use crate::output::warn;
use crate::progress::Progress;
use crate::reading::Reading;
use crate::result_format::{ResultFiles, ResultFormat};
use crate::{Failure, console, interrupt};
use ::features::recorded::{WindowLength, inputs};
use ::report::{domain_gap_page, summary};
use clap::Args;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use sweep::domain_gap::domain_gap;
use sweep::reader::Dataset;
use sweep::recorded_table::recorded_table;

#[derive(Args, Debug)]
#[command(after_help = "\
DATASET is one of gen-dataset, RECORDING what crosshead features reads: files, bundles, datasets. A
classifier (gradient boosting) is trained to tell the windows of the one from those of the other,
and tested on windows that it has not seen. An area under its curve of 0.5 means that nothing
tells them apart, 1 that everything does.

domain-gap.json has the area and the features that give it away; domain-gap.html draws their
distributions. Recordings of another sample rate, length or of other channels are refused, as by
crosshead features --like. At least five recordings are needed.

Examples:
  crosshead domain-gap datasets/bearing-faults measured/ --out domain-gap
  crosshead domain-gap datasets/bearing-faults a.csv b.csv c.csv d.csv e.csv --out domain-gap

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong; 130 interrupted.")]
pub struct Arguments {
    /// The simulated windows
    dataset: PathBuf,
    /// The measured ones
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    #[command(flatten)]
    reading: Reading,
    /// Seed of the folds and of the shuffling
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Folder to write into: domain-gap.json, domain-gap.html
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Replace results that are there
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    format: ResultFormat,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let files = ResultFiles::new(&arguments.out, "domain-gap", arguments.overwrite)?;
    if arguments.reading.window()? != WindowLength::Default {
        return Err(Failure::input(
            "--window: found one beside a dataset, which says how long windows are",
        ));
    }
    let dataset = Dataset::read(&arguments.dataset).map_err(Failure::input)?;
    let like = dataset.like().map_err(Failure::input)?;
    let mut said = arguments.reading.said()?;
    like.say(&mut said);
    let inputs = inputs(&arguments.recordings, &said)?;
    let (pool, cancel) = (console::pool()?, interrupt::flag()?);
    let progress = Progress::of_windows();
    let go_on = || {
        progress.bar.inc(1);
        !cancel.load(Ordering::Relaxed)
    };
    let table = recorded_table(&inputs, &said, like.length(), Some(&like), &pool, go_on)?;
    drop(progress);
    warn(&table.warnings);
    let compared = Progress::during("classifiers", || {
        pool.install(|| domain_gap(&dataset, &table, arguments.seed))
    });
    let compared = compared.map_err(Failure::input)?;
    let page = domain_gap_page::render(&dataset.plan.name, &compared)?;
    let lines = summary::domain_gap(&compared.gap);
    files.write(&compared.gap, &page, arguments.format, &lines)
}
