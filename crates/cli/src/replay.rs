//! `crosshead replay`: the runs of a bundle, simulated in place of their recordings.

use crate::Failure;
use crate::bundle::AllowOutside;
use crate::output::{hint, refuse_existing, write_json};
use crate::progress::Progress;
use ::calibrate::bundle_replay::{BundleReplay, Possible};
use ::calibrate::{Error, bundle};
use clap::Args;
use input::bundle::Bundle;
use std::path::PathBuf;

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

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut bundle = Bundle::read(&arguments.bundle)?;
    bundle.allow_outside = arguments.outside.allow_outside;
    let machine = arguments.machine.as_deref();
    let tree = bundle::machine(&bundle, machine).map_err(Failure::input)?;
    let (left_out, out) = (&arguments.leave_out, &arguments.out);
    let replay = BundleReplay::prepare(&bundle, tree, |_| Vec::new(), left_out, out);
    let replay = replay.map_err(|error| match error {
        Error::Simulation { .. } => Failure::work(error),
        error => Failure::input(error),
    })?;
    let path = out.join("replay.json");
    let files = replay.files();
    refuse_existing(
        files.iter().chain([&path]),
        arguments.overwrite,
        "--out DIR",
    )?;
    let possible = Possible::read(machine).map_err(Failure::input)?;
    let results = Progress::during("simulating the runs", || {
        replay.results(&replay.write()?, &possible)
    });
    let results = results.map_err(Failure::work)?;
    write_json(&path, &results)?;
    print!("{results}");
    println!("{}", path.display());
    let of_machine = machine.map_or(String::new(), |m| format!(" --machine {}", m.display()));
    hint(format_args!(
        "crosshead calibrate {}{of_machine} --out calibrated",
        arguments.bundle.display()
    ));
    Ok(())
}
