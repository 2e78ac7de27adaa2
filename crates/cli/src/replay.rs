//! `crosshead replay`: the runs of a bundle, simulated in place of their recordings.

mod relations;

use crate::bundle::AllowOutside;
use crate::{Failure, bundle};
use ::calibrate::prediction::predict;
use ::calibrate::problem::columns;
use ::calibrate::relation_spread::RelationSpread;
use ::calibrate::{Observation, Problem, Replay, Run, alignment};
use calibrate::CrankMotion;
use clap::Args;
use input::bundle::{Bundle, Channel};
use input::bundle_channel::Meaning;
use input::{MachineFile, paths};
use rayon::prelude::*;
use recordings::formats::parquet;
use recordings::{Column, Data, Kind, Schema, Table, WholeFile};
use serde_json::{Map, Value, json};
use std::f64::consts::TAU;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Rows per group of a Parquet file.
const ROWS_PER_GROUP: usize = 65_536;
/// Relative difference of mean speeds that is worth a word.
const SPEED: f64 = 1e-5;

/// Arguments of `crosshead replay`.
#[derive(Args, Debug)]
#[command(after_help = "\
BUNDLE is a folder with recordings.yaml. Each run is simulated at the speed, load and clearances that
the bundle tells, with the crank where the recording has it, settled and without noise.

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

/// Simulates the runs, writes them, and tells how far they are from the recordings.
///
/// # Errors
/// A bundle or machine that is none, runs that cannot be used or simulated, or files that cannot be
/// written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let bundle = arguments.outside.read(&arguments.bundle)?;
    let tree = bundle::machine(&bundle, arguments.machine.as_deref())?;
    let mut listed = listed(&arguments.leave_out, &bundle, &tree)?;
    let problem = problem(tree, &mut listed)?;
    let results = arguments.out.join("replay.json");
    let files = files(&arguments.out, &listed)?;
    if let Some(path) = files.iter().chain([&results]).find(|path| path.exists())
        && !arguments.overwrite
    {
        return Err(Failure::input(format!(
            "{} is already there; --overwrite replaces it, --out DIR writes elsewhere",
            path.display()
        )));
    }
    let replays = simulated(&problem, &listed)?;
    write(&arguments.out, &files, &listed, &replays)?;
    let possible = relations::Possible::read(arguments.machine.as_deref())?;
    let spreads = relations::spreads(&problem, &listed, &replays, &possible)?;
    let told = told(&listed, &replays, &spreads);
    let text = serde_json::to_string_pretty(&told).map_err(Failure::work)?;
    write_whole(&results, |mut file| {
        file.write_all(text.as_bytes())
            .map_err(recordings::Error::Write)?;
        Ok(file)
    })?;
    summary(&listed, &replays);
    relations::summary(&listed, &spreads);
    println!("{}", results.display());
    Ok(())
}

/// Simulates the runs of a bundle on the machine of the file's content `tree` and writes them into
/// `folder`, one file each. `conditions` are values that a run has beyond what the bundle says.
///
/// # Errors
/// As [`run`].
pub(crate) fn into_folder(
    bundle: &Bundle,
    tree: Value,
    conditions: impl Fn(&str) -> Vec<(String, Value)>,
    leave_out: &[String],
    folder: &Path,
) -> Result<(), Failure> {
    let mut listed = listed(leave_out, bundle, &tree)?;
    for listed in &mut listed {
        let own = conditions(&listed.run.id);
        listed.run.settings.extend(own);
    }
    let problem = problem(tree, &mut listed)?;
    let files = files(folder, &listed)?;
    write(folder, &files, &listed, &simulated(&problem, &listed)?)
}

fn files(folder: &Path, runs: &[Listed]) -> Result<Vec<PathBuf>, Failure> {
    runs.iter()
        .map(|listed| file_of(folder, &listed.run.id))
        .collect()
}

fn simulated(problem: &Problem, runs: &[Listed]) -> Result<Vec<Replay>, Failure> {
    let runs = runs.par_iter().zip(&problem.runs);
    let replay = |(listed, observation): (&Listed, &Observation)| {
        ::calibrate::replay(problem, &listed.run, observation, &[])
    };
    runs.map(replay)
        .collect::<Result<_, _>>()
        .map_err(Failure::work)
}

fn write(
    folder: &Path,
    files: &[PathBuf],
    runs: &[Listed],
    replays: &[Replay],
) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::unwritten(folder, error))?;
    for (file, (listed, replay)) in files.iter().zip(runs.iter().zip(replays)) {
        let table = table(&listed.run, replay, &listed.channels).map_err(Failure::work)?;
        write_whole(file, |file| {
            parquet::write_table(file, &table, ROWS_PER_GROUP)
        })?;
    }
    Ok(())
}

/// A run, and its channels as the bundle lists them.
struct Listed<'a> {
    run: Run,
    channels: Vec<(&'a Channel, Meaning)>,
}

impl Listed<'_> {
    /// Whether the crank angle was recorded with its zero.
    fn is_zeroed(&self) -> bool {
        let mut meanings = self.channels.iter().map(|(_, meaning)| meaning);
        meanings.any(|meaning| {
            matches!(
                meaning,
                Meaning::CrankAngle(_) | Meaning::Tacho { at: Some(_) }
            )
        })
    }
}

/// The runs that are not left out.
fn listed<'a>(
    leave_out: &[String],
    bundle: &'a Bundle,
    tree: &Value,
) -> Result<Vec<Listed<'a>>, Failure> {
    let throws = bundle::throws(tree);
    let mut all = Vec::new();
    for run in bundle::runs(bundle, tree, leave_out)? {
        let i = bundle.runs.iter().position(|listed| listed.id == run.id);
        let i = i.unwrap_or_default();
        let meanings = bundle::meanings(bundle, i, &throws)?;
        let channels = bundle.runs[i].channels.iter().zip(meanings).collect();
        all.push(Listed { run, channels });
    }
    if all.is_empty() {
        return Err(Failure::input("every run is left out"));
    }
    Ok(all)
}

/// The runs as the machine of the file's content `tree` is held against them. What they lack of the
/// crank angle is made up: its speed from the waveform, its zero from what the machine shows.
fn problem(mut tree: Value, runs: &mut [Listed]) -> Result<Problem, Failure> {
    // The machine stands at the conditions of the first run where it has none of its own.
    for (path, value) in runs.iter().take(1).flat_map(|listed| &listed.run.settings) {
        paths::set(&mut tree, path, value.clone())?;
    }
    let columns = columns(&MachineFile::from_tree(&tree)?.resolve()?);
    let observe = |run: &Run| {
        Observation::of(run, &columns).map_err(|e| bundle::unusable(&run.id, &e.to_string()))
    };
    let mut problem = Problem {
        tree,
        parameters: Vec::new(),
        runs: Vec::new(),
        crank: CrankMotion::Driven,
        meter: calibrate::meter::Meter::default(),
    };
    for listed in runs {
        let zeroed = listed.is_zeroed();
        let run = &mut listed.run;
        if run.crank_angle.is_none() {
            let step = TAU * alignment::speed(run) / 60.0 / run.sample_rate;
            let samples = run.channels.first().map_or(0, |c| c.samples.len());
            let angles = (0..samples).map(|i| (step * i as f64).rem_euclid(TAU));
            run.crank_angle = Some(angles.collect());
        }
        let mut observed = observe(run)?;
        if !zeroed {
            let predicted = predict(&problem, &observed, &[]).map_err(Failure::work)?;
            let shift = alignment::phase(&observed, &predicted);
            for angle in run.crank_angle.iter_mut().flatten() {
                *angle = (*angle + shift).rem_euclid(TAU);
            }
            observed = observe(run)?;
        }
        problem.runs.push(observed);
    }
    Ok(problem)
}

/// The file of a run, whose name must be one of a file.
fn file_of(folder: &Path, id: &str) -> Result<PathBuf, Failure> {
    if Path::new(id).file_name().is_none_or(|name| name != id) {
        return Err(Failure::input(format!(
            "run {id}: its id names the file of its replay, and must be a plain file name"
        )));
    }
    Ok(folder.join(format!("{id}.parquet")))
}

/// The replay in the columns of the recording and in their units; what the model does not have is
/// null.
fn table(
    run: &Run,
    replay: &Replay,
    listed: &[(&Channel, Meaning)],
) -> Result<Table, recordings::Error> {
    let count = replay.crank_angle.len();
    let mut columns = Vec::new();
    let mut data = Vec::new();
    for (channel, meaning) in listed {
        let (values, about): (Vec<Option<f64>>, &str) = match meaning {
            Meaning::Time => {
                let times = (0..count).map(|i| Some(i as f64 / run.sample_rate));
                (times.collect(), "time since the first sample")
            }
            Meaning::CrankAngle(to_si) => {
                let angles = replay.crank_angle.iter();
                let angles = angles.map(|angle| Some(to_si.back(*angle)));
                (angles.collect(), "simulated crank angle")
            }
            Meaning::Measured { column, to_si } => {
                let simulated = replay.channels.iter().find(|c| c.column == *column);
                let values = match simulated {
                    Some(channel) => {
                        let samples = channel.samples.iter();
                        samples.map(|x| Some(to_si.back(*x))).collect()
                    }
                    None => vec![None; count],
                };
                (values, "simulated, without noise")
            }
            Meaning::Tacho { .. } | Meaning::Other => (vec![None; count], "not simulated"),
        };
        let column = Column::new(&channel.column, Kind::Real, about);
        columns.push(column.unit(&channel.unit).optional());
        data.push(Data::Real(values));
    }
    Table::from_columns(Schema::new(columns)?, data)
}

fn told(runs: &[Listed], replays: &[Replay], spreads: &[Option<RelationSpread>]) -> Value {
    let of_run = |((listed, replay), spread): ((&Listed, &Replay), &Option<RelationSpread>)| {
        let channels: Map<String, Value> = replay
            .channels
            .iter()
            .map(|channel| {
                let share = |value: f64| value / channel.recording_rms;
                let content = json!({
                    "recording_rms": channel.recording_rms,
                    "difference": share(channel.difference),
                    "noise_floor": share(channel.noise_floor),
                    "misfit": channel.misfit,
                });
                (channel.column.clone(), content)
            })
            .collect();
        let content = json!({
            "periodic": replay.periodic,
            "recorded_speed_rpm": replay.recorded_rpm,
            "simulated_speed_rpm": replay.simulated_rpm,
            "crank_angle_difference_rad": replay.angle_difference,
            "misfit": replay.misfit,
            "channels": channels,
            "relation_spread": spread,
        });
        (listed.run.id.clone(), content)
    };
    let all = runs.iter().zip(replays).zip(spreads);
    let runs: Map<String, Value> = all.map(of_run).collect();
    json!({
        "meaning": {
            "recording_rms": "RMS of the recording about its mean, SI",
            "difference": "RMS of the difference of the crank-angle synchronous means, over recording_rms",
            "noise_floor": "RMS of the noise in the recording's synchronous mean, over recording_rms",
            "misfit": "the same difference, order by order, over the standard deviation of its noise: 1 is noise alone",
            "relation_spread": "at clearances that the machine is not known at: what each relation that the recordings do not exclude shows, and the least and the greatest of them; null elsewhere",
            "periodic": "false where the simulated motion does not repeat itself; then compare means, not waveforms",
        },
        "runs": runs,
    })
}

fn summary(runs: &[Listed], replays: &[Replay]) {
    let names = replays.iter().flat_map(|replay| &replay.channels);
    let wide = names.map(|c| c.column.len()).max().unwrap_or(0).max(7);
    let long = runs
        .iter()
        .map(|listed| listed.run.id.len())
        .max()
        .unwrap_or(0);
    let long = long.max("run".len());
    println!(
        "{:long$}  {:wide$}  {:>10}  {:>11}  {:>7}",
        "run", "channel", "difference", "noise floor", "misfit"
    );
    for (Listed { run, .. }, replay) in runs.iter().zip(replays) {
        for channel in &replay.channels {
            let percent = |value: f64| 100.0 * value / channel.recording_rms;
            println!(
                "{:long$}  {:wide$}  {:>8.2} %  {:>9.2} %  {:>7.2}",
                run.id,
                channel.column,
                percent(channel.difference),
                percent(channel.noise_floor),
                channel.misfit
            );
        }
    }
    println!(
        "difference: of the synchronous means over the recording's RMS; misfit: 1 is noise alone"
    );
    for (Listed { run, .. }, replay) in runs.iter().zip(replays) {
        let faster = replay.simulated_rpm / replay.recorded_rpm - 1.0;
        if faster.abs() > SPEED {
            println!(
                "{}: the simulated crank turns at {:.3} rpm, the recorded one at {:.3} rpm ({:+.3} %)",
                run.id,
                replay.simulated_rpm,
                replay.recorded_rpm,
                100.0 * faster
            );
        }
        if !replay.periodic {
            println!(
                "{}: the simulated motion does not repeat itself; compare its means with the recording, not its waveform",
                run.id
            );
        }
    }
}

/// Writes a file that appears whole or not at all.
fn write_whole(
    path: &Path,
    write: impl FnOnce(WholeFile) -> Result<WholeFile, recordings::Error>,
) -> Result<(), Failure> {
    WholeFile::create(&path.with_extension("part"), path)
        .and_then(write)
        .and_then(WholeFile::commit)
        .map(drop)
        .map_err(Failure::work)
}
