//! `crosshead replay`: the runs of a bundle, simulated in place of their recordings.

use crate::Failure;
use crate::bundle::AllowOutside;
use crate::output::{hint, write_file};
use crate::progress::Progress;
use ::calibrate::bundle_replay::{BundleReplay, Possible, Results};
use ::calibrate::relation_spread::RelationSpread;
use ::calibrate::{Error, bundle};
use clap::Args;
use serde_json::Value;
use std::path::PathBuf;

/// Relative difference of mean speeds that is worth a word.
const SPEED: f64 = 1e-5;

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
    let mut files = replay.files().iter().chain([&path]);
    if let Some(path) = files.find(|path| path.exists())
        && !arguments.overwrite
    {
        return Err(Failure::input(format!(
            "{} is already there; --overwrite replaces it, --out DIR writes elsewhere",
            path.display()
        )));
    }
    let possible = Possible::read(machine).map_err(Failure::input)?;
    let progress = Progress::of_time("simulating the runs");
    let replays = replay.write().map_err(Failure::work)?;
    let results = replay.results(&replays, &possible).map_err(Failure::work)?;
    drop(progress);
    let text = serde_json::to_string_pretty(&results).map_err(Failure::work)?;
    write_file(&path, text.as_bytes())?;
    summary(&results);
    for (id, run) in results.runs.iter() {
        if let Some(spread) = &run.relation_spread {
            summary_of_spread(id, spread);
        }
    }
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

fn summary(results: &Results) {
    let runs = || results.runs.iter();
    let columns = runs().flat_map(|(_, run)| run.channels.iter());
    let wide = columns.map(|(column, _)| column.len()).max().unwrap_or(0);
    let wide = wide.max("channel".len());
    let long = runs().map(|(id, _)| id.len()).max().unwrap_or(0);
    let long = long.max("run".len());
    println!(
        "{:long$}  {:wide$}  {:>10}  {:>11}  {:>7}",
        "run", "channel", "difference", "noise floor", "misfit"
    );
    for (id, run) in runs() {
        for (column, channel) in run.channels.iter() {
            println!(
                "{id:long$}  {column:wide$}  {:>8.2} %  {:>9.2} %  {:>7.2}",
                100.0 * channel.difference,
                100.0 * channel.noise_floor,
                channel.misfit
            );
        }
    }
    println!(
        "difference: of the synchronous means over the recording's RMS; misfit: 1 is noise alone"
    );
    for (id, run) in runs() {
        let faster = run.simulated_speed_rpm / run.recorded_speed_rpm - 1.0;
        if faster.abs() > SPEED {
            println!(
                "{id}: the simulated crank turns at {:.3} rpm, the recorded one at {:.3} rpm ({:+.3} %)",
                run.simulated_speed_rpm,
                run.recorded_speed_rpm,
                100.0 * faster
            );
        }
        if !run.periodic {
            println!(
                "{id}: the simulated motion does not repeat itself; compare its means with the recording, not its waveform"
            );
        }
    }
}

fn summary_of_spread(id: &str, spread: &RelationSpread) {
    let joints = spread.joints.iter().map(|(path, joint)| {
        let [at, from] = [joint.clearance_m, joint.stated_for_m].map(|c| 1e3 * c);
        format!("{path} at {at:.4} mm, its contact known at {from:.4} mm")
    });
    println!("{id}: {}", joints.collect::<Vec<String>>().join("; "));
    let named = spread
        .relations
        .iter()
        .map(|variant| match &variant.relation {
            Value::String(name) => name.clone(),
            exponents => exponents.to_string().replace('"', ""),
        });
    println!(
        "  spread over the relations that the recordings do not exclude ({}):",
        named.collect::<Vec<String>>().join(", ")
    );
    for (column, channel) in &spread.channels {
        let [low, high] = channel.difference.map(|share| 100.0 * share);
        println!(
            "  {column}: rms {:.4e} to {:.4e}, peak {:.4e} to {:.4e}, difference {low:.2} to {high:.2} %",
            channel.rms[0], channel.rms[1], channel.peak[0], channel.peak[1]
        );
    }
    for variant in &spread.relations {
        if let Some(failure) = &variant.failure {
            println!("  {}: cannot be simulated: {failure}", variant.relation);
        }
    }
}
