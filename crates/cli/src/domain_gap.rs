//! `crosshead domain-gap`: the simulated windows of a dataset beside measured ones.

use crate::output::{hint, refuse_existing, write_file};
use crate::progress::Progress;
use crate::reading::Reading;
use crate::result_format::ResultFormat;
use crate::{Failure, console, interrupt};
use ::features::recorded::{WindowLength, inputs};
use ::report::{domain_gap_page, write_page};
use clap::Args;
use classify::DomainGap;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use sweep::domain_gap::domain_gap;
use sweep::reader::Dataset;
use sweep::recorded_table::{self, recorded_table};

/// Features that are printed.
const PRINTED: usize = 10;

/// Arguments of `crosshead domain-gap`.
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

/// Compares the two and writes what tells them apart.
///
/// # Errors
/// Wrong arguments, recordings that cannot be read or do not go with the dataset, too few of them, or files that cannot be
/// written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    let [json, page] = ["domain-gap.json", "domain-gap.html"].map(|name| out.join(name));
    refuse_existing([&json], arguments.overwrite)?;
    if arguments.reading.window()? != WindowLength::Default {
        return Err(Failure::input(
            "--window: found one beside a dataset, which says how long windows are",
        ));
    }
    let dataset = Dataset::read(&arguments.dataset).map_err(Failure::input)?;
    let like = dataset.like().map_err(Failure::input)?;
    let mut said = arguments.reading.said()?;
    like.say(&mut said);
    let inputs = inputs(&arguments.recordings, &said).map_err(Failure::input)?;
    let pool = console::pool()?;
    let cancel = interrupt::flag()?;
    let progress = Progress::new(
        "windows",
        None,
        "{spinner} {pos} windows  {per_sec}  {elapsed}",
    );
    let go_on = || {
        progress.add(1);
        !cancel.load(Ordering::Relaxed)
    };
    let table = recorded_table(&inputs, &said, like.length(), Some(&like), &pool, go_on);
    let table = table.map_err(|error| match error {
        recorded_table::Error::Stopped => Failure::interrupted("interrupted; nothing was written"),
        error => Failure::input(error),
    })?;
    drop(progress);
    table
        .warnings
        .iter()
        .for_each(|line| eprintln!("warning: {line}"));

    let progress = Progress::of_time("classifiers");
    let compared = pool.install(|| domain_gap(&dataset, &table, arguments.seed));
    let compared = compared.map_err(Failure::input)?;
    drop(progress);

    std::fs::create_dir_all(out).map_err(|error| Failure::unwritten(out, error))?;
    let text = serde_json::to_string_pretty(&compared.gap).map_err(Failure::work)?;
    write_file(&json, text.as_bytes())?;
    let rendered = domain_gap_page::render(&dataset.plan.name, &compared).map_err(Failure::work)?;
    write_page(&page, &rendered.html).map_err(Failure::work)?;
    arguments.format.print(&compared.gap, |gap| {
        summary(gap);
        println!("{}", json.display());
        println!("{}", page.display());
    })?;
    hint(format_args!("open {} in a browser", page.display()));
    Ok(())
}

fn summary(gap: &DomainGap) {
    let (simulated, measured) = (gap.simulated, gap.measured);
    println!(
        "area under the curve {:.3}: {simulated} simulated and {measured} measured windows",
        gap.auc
    );
    let number =
        |value: Option<f64>| value.map_or("none".to_owned(), |v| ::report::text::number(v, 3));
    for telling in gap.features.iter().take(PRINTED) {
        println!(
            "  {}: loss {:.3}, alone {:.3}, simulated {}, measured {}",
            telling.feature,
            telling.loss,
            telling.auc,
            number(telling.simulated),
            number(telling.measured)
        );
    }
}
