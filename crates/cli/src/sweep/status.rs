//! `sweep status`: how far a dataset has got.

use crate::Failure;
use crate::output::{hint, warn};
use crate::result_format::ResultFormat;
use clap::Args;
use std::path::PathBuf;
use sweep::dataset::{Output, status};
use sweep::engines::slurm::Jobs;

#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  crosshead sweep status /scratch/faults

Reads the records and the lengths of files; with --verify also the files, which takes long.
A damaged shard counts as not made, and gives a warning.")]
pub struct Arguments {
    /// The dataset, as it was planned
    url: PathBuf,
    /// Folder of the jobs' scripts, as it was given to `sweep submit`
    #[arg(long, value_name = "DIR")]
    scripts: Option<PathBuf>,
    /// Compare every file with its checksum
    #[arg(long)]
    verify: bool,
    /// As JSON, for programs
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let url = &arguments.url;
    let (output, plan) = Output::open_read_only(url)?;
    let found = status(&output, &plan, arguments.verify)?;
    warn(&output.take_warnings());
    let jobs = Jobs::new(url, arguments.scripts.as_deref());
    let jobs = jobs.map_or_else(|_| Vec::new(), |jobs| jobs.under_way());
    let report = found.report(&plan, jobs);
    let json = arguments.json;
    ResultFormat { json }.print(&report, report.text(url))?;
    let url = url.display();
    match (found.complete, found.missing.first()) {
        _ if json => {}
        (true, _) => hint(format_args!("crosshead report {url}")),
        (false, None) => hint(format_args!("crosshead sweep finalize {url}")),
        (false, Some(shard)) => hint(format_args!("crosshead sweep shard {url} --index {shard}")),
    }
    Ok(())
}
