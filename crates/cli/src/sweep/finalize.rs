//! `sweep finalize`: the dataset is completed.

use crate::Failure;
use crate::gen_dataset::summarise;
use crate::output::{hint, warn};
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;
use sweep::Error;
use sweep::dataset::{Output, finalize, finalize_verified};
use sweep::engines::slurm::Jobs;
use sweep::ranges::ranges;

#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  crosshead sweep finalize /scratch/faults ||
      sbatch --array=$(crosshead sweep finalize /scratch/faults) ...

If shards are missing, their numbers are printed as schedulers take them: 0-3,7. Failed cases do not
prevent completion; the manifest lists them. The command is safe to repeat.

Exit status: 0 the dataset is complete; 1 the work failed; 2 the input or the arguments are wrong;
3 shards are missing.")]
pub struct Arguments {
    /// The dataset, as it was planned
    url: PathBuf,
    /// Compare every file with its checksum before anything is written; existing files stay
    #[arg(long)]
    verify: bool,
    /// Submit what is missing again to Slurm, as the finalising job of `sweep submit` does
    #[arg(long, hide = true)]
    resubmit: bool,
    /// Folder of the jobs' scripts
    #[arg(long, hide = true, requires = "resubmit")]
    scripts: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let started = Instant::now();
    let (output, plan) = Output::join(&arguments.url)?;
    let completed = match arguments.verify {
        true => finalize_verified(&output, &plan),
        false => finalize(&output, &plan),
    };
    warn(&output.take_warnings());
    let manifest = match completed {
        Ok(manifest) => manifest,
        Err(Error::Incomplete { shards, missing }) => {
            println!("{}", ranges(&missing));
            if arguments.resubmit {
                let jobs = Jobs::new(&arguments.url, arguments.scripts.as_deref())?;
                println!("{}", jobs.submit_again(&missing)?);
            }
            let text = format!("{} of {shards} shards are missing", missing.len());
            return Err(Failure::Incomplete(text));
        }
        Err(error) => return Err(error.into()),
    };
    if let Some(text) = summarise(&plan, &manifest, &arguments.url, started) {
        println!("{text}");
    }
    hint(format_args!("crosshead report {}", arguments.url.display()));
    Ok(())
}
