//! The files that arguments name: single ones, the runs of bundles, the tables of datasets.

use crate::Failure;
use input::bundle::{Bundle, Joint, Run};
use recordings::measured::{MeasuredFile, Options};
use recordings::{Column, Kind, Value};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A file, and what is known about it from elsewhere.
#[derive(Clone, Debug)]
pub(super) struct Input {
    /// As it is named in the output.
    pub(super) path: PathBuf,
    pub(super) options: Options,
    pub(super) speed_rpm: Option<f64>,
    /// Labels that the bundle tells.
    pub(super) labels: Vec<(Column, Value)>,
    /// Units that the bundle tells, by column.
    pub(super) units: BTreeMap<String, String>,
}

impl Input {
    /// Opens the file; its channels have the units of the bundle, where it has them.
    pub(super) fn open(&self) -> Result<MeasuredFile, Failure> {
        MeasuredFile::open(&self.path, &self.options).map_err(|error| refused(&self.path, error))
    }
}

/// The one message of a file that cannot be read.
pub(super) fn refused(path: &Path, error: recordings::Error) -> Failure {
    match error {
        recordings::Error::NoColumn { name, among } => {
            // Without its unit in brackets a name is one, too.
            let bare =
                |column: &String| column.split(['[', '(']).next().map(|n| n.trim().to_owned());
            let names: Vec<String> = among.iter().filter_map(bare).collect();
            let nearest = input::nearest(&name, names.iter().map(String::as_str));
            let hint = nearest.map_or(String::new(), |n| format!("; did you mean `{n}`?"));
            let among = among.join(", ");
            Failure::input(format!(
                "{}: no column `{name}`; there are: {among}{hint}",
                path.display()
            ))
        }
        error @ (recordings::Error::SampleRate(_) | recordings::Error::ValueKind { .. }) => {
            Failure::input(format!("{}: {error}", path.display()))
        }
        error => Failure::input(error),
    }
}

/// All files that `paths` name. `options` are those of the arguments.
pub(super) fn all(
    paths: &[PathBuf],
    options: &Options,
    speed_rpm: Option<f64>,
) -> Result<Vec<Input>, Failure> {
    let mut inputs = Vec::new();
    for path in paths {
        if Bundle::is_at(path) {
            let bundle = Bundle::read(path)?;
            for (i, run) in bundle.runs.iter().enumerate() {
                let input = of_run(&bundle, i, run, options, speed_rpm)?;
                inputs.push(input);
            }
            continue;
        }
        let files = if path.is_dir() {
            of_folder(path)?
        } else {
            vec![path.clone()]
        };
        inputs.extend(files.into_iter().map(|path| Input {
            path,
            options: options.clone(),
            speed_rpm,
            labels: Vec::new(),
            units: BTreeMap::new(),
        }));
    }
    Ok(inputs)
}

/// The recordings of a dataset, in order.
fn of_folder(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut files = Vec::new();
    for (below, ending) in [("signals", "parquet"), ("mcap", "mcap")] {
        let Ok(entries) = std::fs::read_dir(folder.join(below)) else {
            continue;
        };
        let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
        files.extend(paths.filter(|path| path.extension().is_some_and(|e| e == ending)));
    }
    files.sort();
    if files.is_empty() {
        return Err(Failure::input(format!(
            "{}: a folder without recordings.yaml (a bundle), signals/*.parquet or mcap/*.mcap (a \
             dataset)",
            folder.display()
        )));
    }
    Ok(files)
}

fn of_run(
    bundle: &Bundle,
    index: usize,
    run: &Run,
    options: &Options,
    speed_rpm: Option<f64>,
) -> Result<Input, Failure> {
    let rate = run.sample_rate_hz.map(|rate| rate.get());
    let wrong = |key: &str, expected: String| {
        let error = input::Error::clash(format!("runs.{index}.{key}"), expected);
        Failure::from(bundle.locate(error))
    };
    if let (Some(of_run), Some(said)) = (rate, options.sample_rate_hz)
        && of_run != said
    {
        return Err(wrong(
            "sample_rate_hz",
            format!("the {said} Hz of --sample-rate"),
        ));
    }
    let columns = if options.columns.is_empty() {
        // The column of time is read in any case, and is no channel.
        let channels = run.channels.iter().filter(|c| c.unit != "s");
        channels.map(|c| c.column.clone()).collect()
    } else {
        options.columns.clone()
    };
    let speed = run.speed_rpm.map(|speed| speed.get());
    Ok(Input {
        path: bundle.path_of(run),
        options: Options {
            columns,
            sample_rate_hz: rate.or(options.sample_rate_hz),
        },
        speed_rpm: speed.or(speed_rpm),
        labels: labels(run),
        units: run
            .channels
            .iter()
            .map(|c| (c.column.clone(), c.unit.clone()))
            .collect(),
    })
}

/// What a bundle tells about a run.
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
