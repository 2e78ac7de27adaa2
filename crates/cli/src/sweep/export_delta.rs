//! `sweep export-delta`: a finished dataset as Delta tables.

use crate::Failure;
use crate::output::hint;
use clap::Args;
use std::path::PathBuf;
use sweep::dataset::{Output, export_delta};

#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  crosshead sweep export-delta /scratch/faults
  python -c 'import deltalake; print(deltalake.DeltaTable(\"/scratch/faults/features\").count())'

signals/, features/ and bifurcations/ each get a _delta_log; the Parquet files stay as they are.
Readers of Parquet see no difference, except polars, which then reads features/*.parquet and not
the folder. Every table is compared with its checksum first. The command is safe to repeat.

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong.")]
pub struct Arguments {
    /// The finished dataset
    url: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (output, plan) = Output::join(&arguments.url)?;
    for table in export_delta(&output, &plan)? {
        println!(
            "{}: {} files, {} rows",
            arguments.url.join(table.folder).display(),
            table.files,
            table.rows
        );
    }
    hint(format_args!("crosshead verify {}", arguments.url.display()));
    Ok(())
}
