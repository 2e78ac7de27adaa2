//! `crosshead report`: the HTML pages of a dataset, of a calibration, or of an explanation.

mod calibration;
mod chaos;
mod columns;
mod counts;
mod dataset;
mod examples;
mod features;
mod features_page;
mod gap;
mod grid;
mod labels;
mod operating_points;
mod pages;
mod random;
mod recording;
mod sensors;
mod windows;

use crate::Failure;
use ::report::chaos_page::ChaosPage;
use ::report::dataset_page::{ClearanceGrids, DatasetPage, Design};
use clap::Args;
use dataset::Dataset;
use pages::Place;
use std::path::{Path, PathBuf};
use windows::{Case, Windows};

/// Name of the page in its folder.
pub(crate) const PAGE: &str = "report.html";

/// Arguments of `crosshead report`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead report datasets/paper2
  crosshead report datasets/bearing-faults --out bearing-faults.html
  crosshead report calibrated
  crosshead report explained

A calibration and an explanation have one page. Beside that of a dataset stand chaos.html (exponents, regimes, portraits, bifurcations), features.html (what each
feature is) and figures/, every figure as an SVG file.

Exit status: 0 done; 1 a page cannot be made or written; 2 the folder is no whole dataset.")]
pub struct Arguments {
    /// Folder of a dataset, a calibration or an explanation, as gen-dataset, calibrate or explain-gap
    /// writes it
    dir: PathBuf,
    /// The page [default: DIR/report.html]
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
}

/// Writes the pages, in place of any files of their names, and prints where the first is; with a
/// grid of clearances also its levels, and the claims of the study that the sweep names.
///
/// # Errors
/// A folder that is no whole dataset, or a page that cannot be made or written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if calibration::is_at(&arguments.dir) {
        let out = arguments.out.clone();
        let out = out.unwrap_or_else(|| arguments.dir.join(PAGE));
        println!("{}", write_calibration(&arguments.dir, &out)?.display());
        return Ok(());
    }
    if gap::is_at(&arguments.dir) {
        let out = arguments.out.clone();
        let out = out.unwrap_or_else(|| arguments.dir.join(PAGE));
        println!("{}", write_gap(&arguments.dir, &out)?.display());
        return Ok(());
    }
    let contents = Contents::read(&arguments.dir)?;
    let page = contents.dataset_page()?;
    let place = Place {
        dataset: arguments
            .out
            .clone()
            .unwrap_or_else(|| arguments.dir.join(PAGE)),
    };
    place.write(&[
        (
            place.beside("chaos.html"),
            contents.chaos_page()?.render().map_err(Failure::work)?,
        ),
        (
            place.beside("features.html"),
            features_page::page(&contents.dataset)?
                .render()
                .map_err(Failure::work)?,
        ),
        (place.dataset.clone(), page.render().map_err(Failure::work)?),
    ])?;
    println!("{}", place.dataset.display());
    if let Design::Grid(grids) = &page.design {
        print!("{}", grids.markdown());
    }
    Ok(())
}

/// Writes the page of the calibration in `folder` to the file `out`, and says where that is.
///
/// # Errors
/// A folder that is no calibration, or a page that cannot be made or written.
pub(crate) fn write_calibration(folder: &Path, out: &Path) -> Result<PathBuf, Failure> {
    let page = calibration::page(folder)?.render().map_err(Failure::work)?;
    pages::write(out, &page.html)?;
    Ok(out.to_owned())
}

/// Writes the page of the explanation in `folder` to the file `out`, and says where that is.
///
/// # Errors
/// A folder that is no explanation, or a page that cannot be made or written.
pub(crate) fn write_gap(folder: &Path, out: &Path) -> Result<PathBuf, Failure> {
    let page = gap::page(folder)?.render().map_err(Failure::work)?;
    pages::write(out, &page.html)?;
    Ok(out.to_owned())
}

/// What the page of the dataset in `folder` tells.
///
/// # Errors
/// A folder that is no whole dataset.
pub fn page(folder: &Path) -> Result<DatasetPage, Failure> {
    Contents::read(folder)?.dataset_page()
}

/// What the page about chaos of the dataset in `folder` tells.
///
/// # Errors
/// A folder that is no whole dataset, or a case that cannot be simulated again.
pub fn chaos_page(folder: &Path) -> Result<ChaosPage, Failure> {
    Contents::read(folder)?.chaos_page()
}

/// A dataset and its table of features.
struct Contents {
    dataset: Dataset,
    windows: Windows,
    cases: Vec<Case>,
}

impl Contents {
    fn read(folder: &Path) -> Result<Self, Failure> {
        let dataset = Dataset::open(folder)?;
        let windows = Windows::read(&dataset)?;
        let cases = windows.cases();
        Ok(Self {
            dataset,
            windows,
            cases,
        })
    }

    fn chaos_page(&self) -> Result<ChaosPage, Failure> {
        chaos::page(&self.dataset, &self.windows, &self.cases)
    }

    fn dataset_page(&self) -> Result<DatasetPage, Failure> {
        let Self {
            dataset,
            windows,
            cases,
        } = self;
        let faults = counts::faults(dataset, windows, cases);
        let examples = examples::examples(dataset, windows, cases, &faults)?;
        let regimes = match dataset.plan.study {
            Some(_) => Some(chaos::Regimes::read(dataset, windows)?),
            None => None,
        };
        let design = match grid::grids(dataset, windows, cases, regimes.as_ref())? {
            Some(grids) => Design::Grid(ClearanceGrids {
                grids: grids.shown,
                left_out: grids.left_out,
                claims: dataset.plan.study.is_some(),
            }),
            None => Design::Random(random::sweep(dataset, windows, cases, &faults)),
        };
        let (features, feature_rows) = features::by_fault(dataset, windows, &faults);
        Ok(DatasetPage {
            name: dataset.plan.name.clone(),
            about: dataset.about(),
            version: dataset.manifest.version.clone(),
            seed: dataset.manifest.seed,
            sample_rate_hz: dataset.plan.settings.sample_rate,
            revolutions_per_window: dataset.revolutions_per_window(),
            samples_per_window: counts::samples_per_window(dataset, windows),
            channels: dataset
                .plan
                .channels()
                .into_iter()
                .map(|(name, _)| name)
                .collect(),
            joints: dataset.joints(),
            splits: dataset.splits(),
            faults,
            ranges: counts::ranges(dataset, windows, cases),
            failed: counts::failed(dataset),
            warnings: counts::warnings(dataset),
            no_examples: dataset.why_no_recordings(),
            examples,
            design,
            features,
            feature_rows,
            columns: columns::columns(dataset)?,
        })
    }
}
