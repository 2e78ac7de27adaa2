//! `crosshead report`: the HTML pages of a dataset, of a calibration, of wear, or of an explanation.

use crate::Failure;
use crate::output::{hint, refuse_folder};
use crate::progress::Progress;
use ::report::dataset_page::{DatasetPage, Design};
use ::report::folder_kind;
use clap::Args;
use std::path::{Path, PathBuf};

/// Name of the page in its folder.
pub use ::report::folder_kind::REPORT as PAGE;

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
pub(crate) struct Arguments {
    /// Folder of a dataset, a calibration, wear or an explanation, as gen-dataset, calibrate, estimate-wear
    /// or explain-gap writes it
    dir: PathBuf,
    /// The page [default: DIR/report.html]
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let dir = &arguments.dir;
    let out = arguments.out.clone().unwrap_or_else(|| dir.join(PAGE));
    refuse_folder(&out)?;
    let dataset = Progress::during("pages", || write(dir, &out))?;
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
    Ok(folder_kind::write(dir, out)?)
}
