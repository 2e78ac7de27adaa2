//! `sweep cancel`: what was submitted is taken back.

use crate::Failure;
use crate::output::hint;
use clap::Args;
use std::path::PathBuf;
use sweep::engines::slurm::Jobs;

#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  crosshead sweep cancel /scratch/faults

Finished shards stay; `sweep submit` continues with the others.")]
pub struct Arguments {
    /// The dataset
    url: PathBuf,
    /// Folder of the jobs' scripts, as it was given to `sweep submit`
    #[arg(long, value_name = "DIR")]
    scripts: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let cancelled = Jobs::new(&arguments.url, arguments.scripts.as_deref())?.cancel()?;
    println!("cancelled: {cancelled}");
    hint(format_args!(
        "crosshead sweep status {}",
        arguments.url.display()
    ));
    Ok(())
}
