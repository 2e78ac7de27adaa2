//! The runs of a bundle, simulated in place of their recordings.

mod relations;
mod results;
mod summary;

use crate::crank_motion::CrankMotion;
use crate::error::Error;
use crate::meter::Meter;
use crate::observation::{Observation, Run};
use crate::prediction::predict;
use crate::problem::{Problem, columns};
use crate::replay::{Replay, replay};
use crate::{alignment, bundle, pictures};
use input::bundle::{Bundle, Channel};
use input::bundle_channel::Meaning;
use input::{MachineFile, paths};
use rayon::prelude::*;
use recordings::{Column, Data, Kind, Schema, Table};
use serde_json::Value;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

pub use relations::Possible;
pub use results::{ChannelReplay, Results, RunReplay};

/// The runs of a bundle beside the machine that takes their place.
pub struct BundleReplay<'a> {
    problem: Problem,
    runs: Vec<Listed<'a>>,
    files: Vec<PathBuf>,
}

impl<'a> BundleReplay<'a> {
    /// The runs that are not left out, with the machine of the file's content `tree`; each is to be
    /// simulated into a file of `folder`. `conditions` are values that a run has beyond what the bundle
    /// says.
    ///
    /// # Errors
    /// A machine or runs that cannot be used, or a run that cannot be simulated.
    pub fn prepare(
        bundle: &'a Bundle,
        tree: Value,
        conditions: impl Fn(&str) -> Vec<(String, Value)>,
        leave_out: &[String],
        folder: &Path,
    ) -> Result<Self, Error> {
        let mut runs = listed(leave_out, bundle, &tree)?;
        for Listed { run, .. } in &mut runs {
            let own = conditions(&run.id);
            run.settings.extend(own);
        }
        let problem = problem(tree, &mut runs)?;
        let files = runs.iter().map(|listed| file_of(folder, &listed.run.id));
        Ok(Self {
            files: files.collect::<Result<_, _>>()?,
            problem,
            runs,
        })
    }

    /// The files of the runs.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Simulates the runs and writes them.
    ///
    /// # Errors
    /// A run that cannot be simulated, or a file that cannot be written.
    pub fn write(&self) -> Result<Vec<Replay>, Error> {
        let runs = self.runs.par_iter().zip(&self.problem.runs);
        let replay = |(listed, observation): (&Listed, &Observation)| {
            replay(&self.problem, &listed.run, observation, &[])
        };
        let replays: Vec<Replay> = runs.map(replay).collect::<Result<_, _>>()?;
        let runs = self.runs.iter().zip(&replays);
        for (file, (listed, replay)) in self.files.iter().zip(runs) {
            if let Some(folder) = file.parent() {
                std::fs::create_dir_all(folder).map_err(|error| Error::file(folder, error))?;
            }
            let table = table(&listed.run, replay, &listed.channels)?;
            pictures::write_table(file, &table)?;
        }
        Ok(replays)
    }

    /// How far the replays are from the recordings, under the relations that are possible.
    ///
    /// # Errors
    /// A machine file whose joints cannot be read.
    pub fn results(&self, replays: &[Replay], possible: &Possible) -> Result<Results, Error> {
        let runs = self.runs.par_iter().zip(&self.problem.runs).zip(replays);
        let spread = |((listed, observation), own): ((&Listed, &Observation), &Replay)| {
            possible.spread(&self.problem, &listed.run, observation, own)
        };
        let spreads: Vec<_> = runs.map(spread).collect::<Result<_, _>>()?;
        let runs = self.runs.iter().zip(replays).zip(spreads);
        let runs = runs.map(|((listed, replay), spread)| {
            (
                listed.run.id.clone(),
                RunReplay::from_replay(replay, spread),
            )
        });
        Ok(Results::from_runs(runs.collect()))
    }
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
) -> Result<Vec<Listed<'a>>, Error> {
    let mut all = Vec::new();
    for run in bundle::runs(bundle, tree, leave_out)? {
        let i = bundle.runs.iter().position(|listed| listed.id == run.id);
        let i = i.unwrap_or_default();
        let meanings = bundle.meanings(i, tree)?;
        let channels = bundle.runs[i].channels.iter().zip(meanings).collect();
        all.push(Listed { run, channels });
    }
    if all.is_empty() {
        return Err(Error::Refused("every run is left out".into()));
    }
    Ok(all)
}

/// The runs as the machine of the file's content `tree` is held against them. What they lack of the
/// crank angle is made up: its speed from the waveform, its zero from what the machine shows.
fn problem(mut tree: Value, runs: &mut [Listed]) -> Result<Problem, Error> {
    // The machine stands at the conditions of the first run where it has none of its own.
    for (path, value) in runs.iter().take(1).flat_map(|listed| &listed.run.settings) {
        paths::set(&mut tree, path, value.clone())?;
    }
    let columns = columns(&MachineFile::from_tree(&tree)?.resolve()?);
    let observe = |run: &Run| {
        Observation::from_run(run, &columns).map_err(|error| Error::unusable(&run.id, error))
    };
    let mut problem = Problem {
        tree,
        parameters: Vec::new(),
        runs: Vec::new(),
        crank: CrankMotion::Driven,
        meter: Meter::default(),
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
            let predicted = predict(&problem, &observed, &[])?;
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
fn file_of(folder: &Path, id: &str) -> Result<PathBuf, Error> {
    if Path::new(id).file_name().is_none_or(|name| name != id) {
        return Err(Error::Refused(format!(
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
