//! A bundle of recordings becomes the runs that a machine is held against.

use crate::Failure;
use ::calibrate::{Channel, Run};
use input::bundle::{self, Bundle};
use recordings::measured::{MeasuredFile, Options};
use serde_json::Value;
use std::path::Path;

/// Samples that are read at a time.
const BLOCK: usize = 1 << 16;
/// The column of the crank angle.
const CRANK_ANGLE: &str = "crank_angle_rad";

/// The machine file's content that the bundle in `folder` is held against: that of `machine`, or the
/// bundle's own machine section.
///
/// # Errors
/// A file that cannot be read, or a section that is no machine.
pub fn machine(bundle: &Bundle, machine: Option<&Path>) -> Result<Value, Failure> {
    if let Some(path) = machine {
        return Ok(input::machine_file::read(path)?.to_tree().clone());
    }
    if bundle.machine.is_null() {
        return Err(Failure::input(format!(
            "{}: there is no machine section; --machine MACHINE.yaml gives one",
            bundle.folder.join(bundle::FILE).display()
        )));
    }
    input::from_bundle(&bundle.machine)
        .map_err(|error| bundle.locate(error.under("machine")).into())
}

/// The runs of a bundle, but for those left out by name.
///
/// # Errors
/// A run that cannot be read, a name that no run has, or conditions that are none.
pub fn runs(bundle: &Bundle, tree: &Value, left_out: &[String]) -> Result<Vec<Run>, Failure> {
    let ids: Vec<&str> = bundle.runs.iter().map(|run| run.id.as_str()).collect();
    known_runs("--leave-out", left_out, &ids)?;
    let kept = bundle.runs.iter().enumerate();
    let kept = kept.filter(|(_, run)| !left_out.contains(&run.id));
    kept.map(|(i, run)| {
        let settings = input::run_settings(&run.section, tree)
            .map_err(|error| bundle.locate(error.under(format!("runs.{i}"))))?;
        read(bundle, run, settings)
    })
    .collect()
}

/// Checks that each of `asked` is the id of a run.
///
/// # Errors
/// The first that is none, with the nearest that is.
pub fn known_runs(option: &str, asked: &[String], ids: &[&str]) -> Result<(), Failure> {
    let Some(unknown) = asked.iter().find(|id| !ids.contains(&id.as_str())) else {
        return Ok(());
    };
    let nearest = input::nearest(unknown, ids.iter().copied());
    let hint = nearest.map_or(String::new(), |near| format!("; did you mean {near}?"));
    Err(Failure::input(format!(
        "{option} {unknown}: there is no such run{hint} The runs are {}.",
        ids.join(", ")
    )))
}

fn read(
    bundle: &Bundle,
    run: &bundle::Run,
    settings: Vec<(String, Value)>,
) -> Result<Run, Failure> {
    let path = bundle.path_of(run);
    let wrong = |reason: String| Failure::input(format!("run {}: {reason}", run.id));
    let listed = |column: &str| run.channels.iter().any(|c| c.column == column);
    let options = Options {
        columns: run
            .channels
            .iter()
            .filter(|c| c.unit != "s")
            .map(|c| c.column.clone())
            .collect(),
        sample_rate_hz: run.sample_rate_hz.map(|rate| rate.get()),
    };
    let mut file = MeasuredFile::open(&path, &options).map_err(|e| wrong(e.to_string()))?;
    let columns: Vec<String> = file.channels().iter().map(|c| c.column.clone()).collect();
    let mut recording = match file.next() {
        Some(recording) => recording.map_err(|e| wrong(e.to_string()))?,
        None => return Err(wrong(format!("{} is empty", path.display()))),
    };
    let sample_rate = recording
        .sample_rate_hz()
        .ok_or_else(|| wrong("its sample rate is not known: sample_rate_hz is missing".into()))?;
    let mut samples: Vec<Vec<f32>> = vec![Vec::new(); columns.len()];
    loop {
        let block = recording.read(BLOCK, &mut samples);
        let block = block.map_err(|e| wrong(e.to_string()))?;
        if let Some(gap) = block.gap_s {
            return Err(wrong(format!("{gap} s of the recording are missing")));
        }
        if block.samples == 0 {
            break;
        }
    }
    let wide = |samples: &[f32]| samples.iter().map(|x| f64::from(*x)).collect::<Vec<f64>>();
    let mut crank_angle = None;
    let mut channels = Vec::new();
    for (column, samples) in columns.iter().zip(&samples) {
        if let Some(i) = samples.iter().position(|x| !x.is_finite()) {
            return Err(wrong(format!(
                "channel {column} has no number at sample {i}"
            )));
        }
        if column == CRANK_ANGLE {
            crank_angle = Some(wide(samples));
        } else if listed(column) {
            channels.push(Channel {
                column: column.clone(),
                samples: wide(samples),
            });
        }
    }
    let speed_rpm = run
        .speed_rpm
        .map(|speed| speed.get())
        .ok_or_else(|| wrong("its speed_rpm is missing".into()))?;
    Ok(Run {
        id: run.id.clone(),
        settings,
        speed_rpm,
        sample_rate,
        crank_angle,
        channels,
    })
}
