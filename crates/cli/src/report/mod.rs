//! `crosshead report`: the HTML pages of a dataset, of a calibration, of wear, or of an explanation.

use crate::Failure;
use crate::output::hint;
use crate::progress::Progress;
use ::report::chaos_page::ChaosPage;
use ::report::dataset_page::{DatasetPage, Design};
use ::report::features_page::FeaturesPage;
use ::report::folder_kind::FolderKind;
use ::report::{Error, write_page, write_pages};
use ::sweep::reader::Dataset;
use clap::Args;
use std::path::{Path, PathBuf};

/// Name of the page in its folder.
pub const PAGE: &str = "report.html";

/// Arguments of `crosshead report`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead report datasets/paper2
  crosshead report datasets/bearing-faults --out bearing-faults.html
  crosshead report calibrated
  crosshead report explained

A calibration, wear and an explanation have one page. Beside that of a dataset stand chaos.html
(exponents, regimes, portraits, bifurcations), features.html (what each feature is) and figures/,
every figure as an SVG file.

Exit status: 0 done; 1 a page cannot be made or written; 2 the folder is no whole dataset.")]
pub struct Arguments {
    /// Folder of a dataset, a calibration, wear or an explanation, as gen-dataset, calibrate, estimate-wear
    /// or explain-gap writes it
    dir: PathBuf,
    /// The page [default: DIR/report.html]
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
}

/// Writes the pages, replaces files with their names, and prints the path of the first. For a grid
/// of clearances it also prints the levels, and the claims of the study that the sweep names.
///
/// # Errors
/// A folder that is no whole dataset, or a page that cannot be made or written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let dir = &arguments.dir;
    let out = arguments.out.clone().unwrap_or_else(|| dir.join(PAGE));
    let progress = Progress::of_time("pages");
    let dataset = write(dir, &out)?;
    drop(progress);
    println!("{}", out.display());
    if let Some(Design::Grid(grids)) = dataset.map(|page| page.design) {
        print!("{}", grids.markdown());
    }
    hint(format_args!("open {} in a browser", out.display()));
    Ok(())
}

/// Writes the page of whatever the folder `dir` holds to the file `out`; gives that of a dataset back.
///
/// # Errors
/// A folder that holds nothing with a page, or a page that cannot be made or written.
pub fn write(dir: &Path, out: &Path) -> Result<Option<DatasetPage>, Failure> {
    match FolderKind::of(dir) {
        Some(kind) if !matches!(kind, FolderKind::Dataset | FolderKind::UnderWay) => {
            write_result(kind, dir, out).map(|()| None)
        }
        _ => write_dataset(dir, out).map(Some).map_err(failed),
    }
}

/// Writes the page of the result of this kind in `folder` to the file `out`.
///
/// # Errors
/// A folder that holds no such result, or a page that cannot be made or written.
pub(crate) fn write_result(kind: FolderKind, folder: &Path, out: &Path) -> Result<(), Failure> {
    let rendered = kind.render(folder, PAGE).map_err(failed)?;
    rendered.map_or(Ok(()), |page| write_page(out, &page.html).map_err(failed))
}

/// Writes the pages of the dataset in `folder`, its own to the file `out` and last: where it is, the others are.
fn write_dataset(folder: &Path, out: &Path) -> Result<DatasetPage, Error> {
    let dataset = Dataset::read(folder)?;
    let page = DatasetPage::from_dataset(&dataset)?;
    let chaos = ChaosPage::from_dataset(&dataset)?.render()?;
    let features = FeaturesPage::from_dataset(&dataset)?.render()?;
    write_pages(&[
        (out.with_file_name("chaos.html"), chaos),
        (out.with_file_name("features.html"), features),
        (out.to_owned(), page.render()?),
    ])?;
    Ok(page)
}

fn failed(error: Error) -> Failure {
    match error.is_input() {
        true => Failure::input(error),
        false => Failure::work(error),
    }
}
