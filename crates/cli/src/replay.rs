//! `crosshead replay`: the runs of a bundle, simulated in place of their recordings.

use crate::Failure;
use crate::bundle::AllowOutside;
use crate::output::{hint, refuse_existing, write_file};
use crate::progress::Progress;
use ::calibrate::bundle_replay::{BundleReplay, Possible};
use ::calibrate::{Error, bundle};
use clap::Args;
use std::path::PathBuf;

/// Arguments of `crosshead replay`.
#[derive(Args, Debug)]
#[command(after_help = "\
BUNDLE is a folder with recordings.yaml. Each run is simulated at the speed, load and clearances
that the bundle states, with the crank where the recording has it, settled and without noise.

Examples:
  crosshead replay my-bundle --out replayed
  crosshead replay my-bundle --machine calibrated/machine.yaml --out replayed

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong.")]
pub struct Arguments {
    /// Folder of recordings
    bundle: PathBuf,
    /// The machine file [default: the machine section of the bundle]
    #[arg(long, value_name = "MACHINE.yaml")]
    machine: Option<PathBuf>,
    /// Folder to write into: RUN.parquet for each run, replay.json
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Do not use this run; may be repeated
    #[arg(long, value_name = "RUN")]
    leave_out: Vec<String>,
    #[command(flatten)]
    outside: AllowOutside,
    /// Replace the files of an earlier replay
    #[arg(long)]
    overwrite: bool,
}

/// Simulates the runs, writes them, and prints how far they are from the recordings.
///
/// # Errors
/// An invalid bundle or machine, runs that cannot be used or simulated, or files that cannot be
/// written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let bundle = arguments.outside.read(&arguments.bundle)?;
    let machine = arguments.machine.as_deref();
    let tree = bundle::machine(&bundle, machine).map_err(Failure::input)?;
    let (left_out, out) = (&arguments.leave_out, &arguments.out);
    let replay = BundleReplay::prepare(&bundle, tree, |_| Vec::new(), left_out, out);
    let replay = replay.map_err(refused)?;
    let path = out.join("replay.json");
    refuse_existing(replay.files().iter().chain([&path]), arguments.overwrite)?;
    let possible = Possible::read(machine).map_err(Failure::input)?;
    let progress = Progress::of_time("simulating the runs");
    let replays = replay.write().map_err(Failure::work)?;
    let results = replay.results(&replays, &possible).map_err(Failure::work)?;
    drop(progress);
    let text = serde_json::to_string_pretty(&results).map_err(Failure::work)?;
    write_file(&path, text.as_bytes())?;
    print!("{results}");
    println!("{}", path.display());
    let of_machine = machine.map_or(String::new(), |m| format!(" --machine {}", m.display()));
    hint(format_args!(
        "crosshead calibrate {}{of_machine} --out calibrated",
        arguments.bundle.display()
    ));
    Ok(())
}

/// Why a replay cannot begin: its input is wrong, unless the simulation fails.
fn refused(error: Error) -> Failure {
    match error {
        Error::Simulation { .. } => Failure::work(error),
        error => Failure::input(error),
    }
}
