//! `crosshead report`: the HTML page of a dataset.

mod columns;
mod counts;
mod dataset;
mod examples;
mod features;
mod grid;
mod labels;
mod random;
mod recording;
mod windows;

use crate::Failure;
use ::report::dataset_page::{DatasetPage, Design};
use clap::Args;
use dataset::Dataset;
use recordings::WholeFile;
use std::io::Write;
use std::path::{Path, PathBuf};
use windows::Windows;

/// Arguments of `crosshead report`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead report datasets/paper2
  crosshead report datasets/bearing-faults --out bearing-faults.html

Exit status: 0 done; 1 the page cannot be written; 2 the folder is no whole dataset.")]
pub struct Arguments {
    /// Folder of a dataset, as gen-dataset writes it
    dir: PathBuf,
    /// The page [default: DIR/report.html]
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
}

/// Writes the page, in place of any file of its name, and prints where it is; with a grid of
/// clearances also the table of the clearance study's claims.
///
/// # Errors
/// A folder that is no whole dataset, or a page that cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let page = page(&arguments.dir)?;
    let html = page.html().map_err(Failure::work)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| arguments.dir.join("report.html"));
    write(&out, &html)?;
    println!("{}", out.display());
    if let Design::Grid(grid) = &page.design
        && !grid.levels.is_empty()
    {
        print!("\n{}", grid.claims_markdown());
    }
    Ok(())
}

/// What the page of the dataset in `folder` tells.
///
/// # Errors
/// A folder that is no whole dataset.
pub fn page(folder: &Path) -> Result<DatasetPage, Failure> {
    let dataset = Dataset::open(folder)?;
    let windows = Windows::read(&dataset)?;
    let cases = windows.cases();
    let faults = counts::faults(&dataset, &windows, &cases);
    let examples = examples::examples(&dataset, &windows, &cases, &faults)?;
    let design = match grid::grid(&dataset, &windows, &cases)? {
        Some(grid) => Design::Grid(grid),
        None => Design::Random(random::sweep(&dataset, &windows, &cases, &faults)),
    };
    let (features, feature_rows) = features::by_fault(&windows, &faults);
    Ok(DatasetPage {
        name: dataset.plan.name.clone(),
        about: dataset.about(),
        version: dataset.manifest.version.clone(),
        seed: dataset.manifest.seed,
        sample_rate_hz: dataset.plan.settings.sample_rate,
        revolutions_per_window: dataset.revolutions_per_window(),
        samples_per_window: counts::samples_per_window(&dataset, &windows),
        channels: dataset
            .plan
            .channels()
            .into_iter()
            .map(|(name, _)| name)
            .collect(),
        splits: dataset.splits(),
        faults,
        ranges: counts::ranges(&dataset, &windows, &cases),
        failed: counts::failed(&dataset),
        no_examples: dataset.why_no_recordings(),
        examples,
        design,
        features,
        feature_rows,
        columns: columns::columns(&dataset)?,
    })
}

/// Writes the page whole or not at all.
fn write(out: &Path, html: &str) -> Result<(), Failure> {
    let written = WholeFile::create(&out.with_extension("part"), out).and_then(|mut file| {
        file.write_all(html.as_bytes())
            .map_err(recordings::Error::Write)?;
        file.commit()
    });
    written.map(drop).map_err(Failure::work)
}
