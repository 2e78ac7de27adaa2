//! `verify`: whether a finished dataset is the one that was written.

use crate::Failure;
use crate::output::hint;
use crate::progress::Progress;
use crate::result_format::ResultFormat;
use clap::Args;
use std::path::PathBuf;
use sweep::dataset::verify;

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead verify datasets/paper2
  crosshead verify s3://bucket/faults
  cd datasets/paper2 && sha256sum -c SHA256SUMS

Nothing is written. manifest.json is enough: a published copy needs no _sweep. Compared are the
length and the SHA-256 of every file, the rows of every table with its footer, and manifest.json
with SHA256SUMS. Files in signals, features, mcap and bifurcations that the manifest does not have
are named. Each fault is a line on standard output.

Exit status: 0 all is as it was written; 1 something is not; 2 there is no finished dataset.")]
pub struct Arguments {
    /// The dataset, or s3://BUCKET/PREFIX
    #[arg(value_name = "DIR|URL")]
    dataset: PathBuf,
    #[command(flatten)]
    format: ResultFormat,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let dataset = arguments.dataset.display();
    let template = "{bar:40} {bytes}/{total_bytes}  {eta} left";
    let progress = Progress::new("bytes", None, template);
    let found = verify(&arguments.dataset, &mut |all, done| {
        progress.bar.set_length(all);
        progress.bar.set_position(done);
    });
    drop(progress);
    let found = found?;
    if !found.has_sums {
        eprintln!("warning: {dataset} has no SHA256SUMS: nothing vouches for manifest.json itself");
    }
    let (files, megabytes) = (found.files, found.bytes as f64 / 1e6);
    let faults = found.faults.iter().map(|fault| format!("{fault}\n"));
    let summary = match found.faults.len() {
        0 => format!("{dataset}: {files} files, {megabytes:.1} MB, all as they were written\n"),
        _ => faults.collect(),
    };
    arguments.format.print(&found, summary)?;
    match found.faults.len() {
        0 => hint(format_args!("crosshead report {dataset}")),
        1 => return Err(Failure::work(format!("{dataset}: 1 fault"))),
        faults => return Err(Failure::work(format!("{dataset}: {faults} faults"))),
    }
    Ok(())
}
