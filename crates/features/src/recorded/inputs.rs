//! The files that arguments name: single ones, the runs of bundles, the tables of datasets.

use super::{Error, KnownMachine, Unit, shaft};
use input::bundle::{self, Bundle, Joint, Run};
use input::bundle_channel::{Channel, Meaning, unit_as_stated};
use recordings::measured::{MeasuredChannel, MeasuredFile, Options};
use recordings::{Column, Kind, Value};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A file, and what is known about it from elsewhere.
#[derive(Clone, Debug)]
pub struct Input {
    /// As it is named in the output.
    pub path: PathBuf,
    pub(super) options: Options,
    pub(super) speed_rpm: Option<f64>,
    /// Labels from the bundle.
    pub(super) labels: Vec<(Column, Value)>,
    /// What the bundle says of its columns.
    pub(super) stated: BTreeMap<String, Stated>,
    /// The machine, or why the bundle gives none, where anything is said of it.
    pub(super) machine: Option<Result<KnownMachine, String>>,
}

impl Input {
    /// What the bundle says of a channel.
    pub(super) fn stated(&self, channel: &MeasuredChannel) -> Option<&Stated> {
        let of = |name| self.stated.get(name);
        of(&channel.column).or_else(|| of(&channel.name))
    }

    /// Opens the file.
    pub(super) fn open(&self) -> Result<MeasuredFile, Error> {
        MeasuredFile::open(&self.path, &self.options)
            .map_err(|error| Error::of_file(&self.path, error))
    }
}

/// What a bundle says of a column.
#[derive(Clone, Debug)]
pub(super) struct Stated {
    /// What it is.
    pub(super) meaning: Meaning,
    /// Its unit, absolute where the bundle gives the ambient pressure of a gauge.
    pub(super) unit: String,
    /// What is added to its numbers, in its unit.
    pub(super) offset: f64,
}

impl Stated {
    fn new(channel: &Channel, meaning: &Meaning) -> Self {
        let (unit, offset) = unit_as_stated(channel);
        Self {
            meaning: meaning.clone(),
            unit: unit.to_owned(),
            offset,
        }
    }
}

/// What the arguments say of all files.
#[derive(Clone, Debug)]
pub struct Said {
    /// Columns and sample rate.
    pub options: Options,
    /// Speed of the crank.
    pub speed_rpm: Option<f64>,
    /// Unit of the channels that have none.
    pub unit: Option<Unit>,
    /// Where the crank stands.
    pub crank: shaft::Asked,
    /// The machine; none leaves it to the bundles.
    pub machine: Option<KnownMachine>,
    /// Whether a bundle may name recordings outside of its folder.
    pub allow_outside: bool,
    /// Whether the kind of motion is judged from the signals, which takes most of the time.
    pub motion: bool,
}

impl Said {
    /// The options for a file in which these columns give the crank angle.
    fn options(&self, references: impl Iterator<Item = String>) -> Options {
        let mut options = self.options.clone();
        // Without a choice of columns all are read.
        if !options.columns.is_empty() {
            options.columns.extend(references);
        }
        options
    }
}

/// All files that `paths` name: single ones, the runs of bundles, the tables of datasets.
///
/// # Errors
/// A folder that is neither a bundle nor a dataset, or a bundle with a mistake.
pub fn inputs(paths: &[PathBuf], said: &Said) -> Result<Vec<Input>, Error> {
    let mut inputs = Vec::new();
    let mut beside = Beside::default();
    for path in paths {
        if Bundle::is_at(path) {
            let mut bundle = Bundle::read(path)?;
            bundle.allow_outside = said.allow_outside;
            for (i, run) in bundle.runs.iter().enumerate() {
                for file in 0..run.recordings().count() {
                    inputs.push(of_run(&bundle, i, file, said)?);
                }
            }
            continue;
        }
        let files = if path.is_dir() {
            of_folder(path)?
        } else {
            vec![path.clone()]
        };
        for path in files {
            let input = match beside.run_of(&path)? {
                Some((bundle, i, of)) => Input {
                    path,
                    ..of_run(bundle, i, of, said)?
                },
                None => Input {
                    path,
                    options: said.options(said.crank.bare_column().into_iter()),
                    speed_rpm: said.speed_rpm,
                    labels: Vec::new(),
                    stated: BTreeMap::new(),
                    machine: said.machine.clone().map(Ok),
                },
            };
            inputs.push(input);
        }
    }
    Ok(inputs)
}

/// The bundles beside files, each read once.
#[derive(Default)]
struct Beside(BTreeMap<PathBuf, Option<Bundle>>);

impl Beside {
    /// The run of a `recordings.yaml` in the file's folder whose recording it is.
    fn run_of(&mut self, file: &Path) -> Result<Option<(&Bundle, usize, usize)>, Error> {
        let Ok(file) = file.canonicalize() else {
            return Ok(None);
        };
        let Some(folder) = file.parent() else {
            return Ok(None);
        };
        if !self.0.contains_key(folder) {
            let there = folder.join(bundle::FILE).is_file();
            let bundle = there.then(|| Bundle::read(folder)).transpose()?;
            self.0.insert(folder.to_owned(), bundle);
        }
        let bundle = self.0.get(folder).and_then(Option::as_ref);
        Ok(bundle.and_then(|bundle| {
            let is = |run: &Run, of: usize| {
                let path = bundle.path_of_file(run, of).ok();
                path.and_then(|path| path.canonicalize().ok())
                    .is_some_and(|path| path == file)
            };
            let mut found = bundle.runs.iter().enumerate().filter_map(|(i, run)| {
                let of = (0..run.recordings().count()).find(|of| is(run, *of))?;
                Some((bundle, i, of))
            });
            found.next()
        }))
    }
}

/// Files with the signals of a run of `crosshead simulate`.
const OF_A_RUN: [&str; 2] = ["signals.parquet", "signals.csv"];

/// The recordings of a dataset, in order, or the signals of a simulated run.
fn of_folder(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut files: Vec<PathBuf> = OF_A_RUN.map(|name| folder.join(name)).into();
    files.retain(|file| file.is_file());
    for (below, ending) in [("signals", "parquet"), ("mcap", "mcap")] {
        let Ok(entries) = std::fs::read_dir(folder.join(below)) else {
            continue;
        };
        let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
        files.extend(paths.filter(|path| path.extension().is_some_and(|e| e == ending)));
    }
    files.sort();
    if files.is_empty() {
        return Err(Error::in_file(
            folder,
            "a folder without recordings.yaml (a bundle), signals/*.parquet or mcap/*.mcap (a dataset), signals.parquet or \
             signals.csv (a simulated run)",
        ));
    }
    Ok(files)
}

/// Recording `of` of the run `index` of a bundle, with the channels that stand in it.
fn of_run(bundle: &Bundle, index: usize, of: usize, said: &Said) -> Result<Input, Error> {
    let run = &bundle.runs[index];
    let meanings = match &said.machine {
        Some(machine) => bundle.meanings_on(index, machine.throws())?,
        None => bundle.meanings(index, &bundle.machine)?,
    };
    let file = run
        .recordings()
        .nth(of)
        .map_or(run.file.as_path(), |(file, _)| file);
    let rate = run.sample_rate_hz.map(|rate| rate.get());
    let wrong = |key: &str, expected: String| {
        let error = input::Error::clash(format!("runs.{index}.{key}"), expected);
        Error::from(bundle.locate(error))
    };
    if let (Some(of_run), Some(asked)) = (rate, said.options.sample_rate_hz)
        && of_run != asked
    {
        return Err(wrong(
            "sample_rate_hz",
            format!("the {asked} Hz of --sample-rate"),
        ));
    }
    let listed = || {
        run.channels_of(file)
            .map(|(i, channel)| (channel, &meanings[i]))
    };
    let asked = said.crank.bare_column().into_iter();
    let references = listed()
        .filter(|(_, meaning)| matches!(meaning, Meaning::CrankAngle(_) | Meaning::Tacho { .. }));
    let references = references.map(|(channel, _)| channel.column.clone());
    let mut options = said.options(asked.clone().chain(references));
    if options.columns.is_empty() {
        // The column of time is read in any case, and is no channel.
        let channels = listed().filter(|(c, meaning)| **meaning != Meaning::Time && c.unit != "s");
        let columns = channels.map(|(channel, _)| channel.column.clone());
        options.columns = columns.chain(asked).collect();
    }
    options.sample_rate_hz = rate.or(options.sample_rate_hz);
    let speed = run.speed_rpm.map(|speed| speed.get());
    Ok(Input {
        path: bundle.path_of_file(run, of)?,
        options,
        speed_rpm: speed.or(said.speed_rpm),
        labels: labels(run),
        stated: listed()
            .map(|(channel, meaning)| (channel.column.clone(), Stated::new(channel, meaning)))
            .collect(),
        machine: (said.machine.clone().map(Ok)).or_else(|| KnownMachine::of_run(bundle, index)),
    })
}

/// What a bundle states of a run.
fn labels(run: &Run) -> Vec<(Column, Value)> {
    let real = |name: String, unit: &str, meaning: &str, value: f64| {
        let column = Column::new(name, Kind::Real, meaning).unit(unit).optional();
        (column, Value::from(value))
    };
    let under = |throw: &str, name: &str| match throw {
        "" => name.to_owned(),
        throw => format!("{throw}.{name}"),
    };
    let run_id = Column::new("run", Kind::Text, "name of the run in its bundle").optional();
    let mut labels = vec![(run_id, Value::from(run.id.as_str()))];
    for (throw, load) in &run.load {
        for (side, pressure) in [
            ("suction", load.suction_pressure_pa),
            ("discharge", load.discharge_pressure_pa),
        ] {
            let name = under(throw, &format!("{side}_pressure_pa"));
            labels.push(real(
                name,
                "Pa",
                "as the bundle says, absolute",
                pressure.get(),
            ));
        }
    }
    for (throw, joints) in &run.joints {
        for (joint, state) in joints {
            let clearance = match state {
                Joint::Scalar(_) => 0.0,
                Joint::Section(clear) => clear.clearance_m.get(),
            };
            let name = format!("clearance_{}_m", under(throw, joint));
            let meaning = "clearance as the bundle says; 0 where the joint is ideal";
            labels.push(real(name, "m", meaning, clearance));
        }
    }
    labels
}
