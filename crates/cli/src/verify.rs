//! `verify`: whether a finished dataset is the one that was written.

use crate::Failure;
use crate::output::hint;
use crate::progress::Progress;
use crate::result_format::ResultFormat;
use clap::Args;
use std::path::PathBuf;
use sweep::dataset::verify;

/// Arguments of `verify`.
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

/// Compares every file.
///
/// # Errors
/// Files that are damaged, missing or too many, or no dataset.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let dataset = arguments.dataset.display();
    let template = "{bar:40} {bytes}/{total_bytes}  {eta} left";
    let progress = Progress::new("bytes", None, template);
    let found = verify(&arguments.dataset, &mut |all, done| {
        progress.set_total(all);
        progress.set(done);
    });
    drop(progress);
    let found = found?;
    if !found.has_sums {
        eprintln!("warning: {dataset} has no SHA256SUMS: nothing vouches for manifest.json itself");
    }
    let megabytes = found.bytes as f64 / 1e6;
    arguments
        .format
        .print(&found, |found| match found.faults[..] {
            [] => println!(
                "{dataset}: {} files, {megabytes:.1} MB, all as they were written",
                found.files
            ),
            ref faults => faults.iter().for_each(|fault| println!("{fault}")),
        })?;
    if !found.faults.is_empty() {
        let faults = found.faults.len();
        return Err(Failure::work(format!("{dataset}: {faults} faults")));
    }
    hint(format_args!("crosshead report {dataset}"));
    Ok(())
}
