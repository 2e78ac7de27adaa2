//! A bundle of recordings becomes the runs that a machine is held against.

mod columns;
mod recording;
mod series;

pub use columns::wrong_columns;

use crate::error::Error;
use crate::observation::Run;
use input::bundle::{self, Bundle};
use serde_json::Value;
use std::path::Path;

/// The machine file's content that the bundle in `folder` is held against: that of `machine`, or the
/// bundle's own machine section.
///
/// # Errors
/// A file that cannot be read, or a section that is no machine.
pub fn machine(bundle: &Bundle, machine: Option<&Path>) -> Result<Value, Error> {
    if let Some(path) = machine {
        return Ok(input::machine_file::read(path)?.to_tree().clone());
    }
    if bundle.machine.is_null() {
        return Err(Error::Refused(format!(
            "{}: there is no machine section; --machine MACHINE.yaml gives one",
            bundle.folder.join(bundle::FILE).display()
        )));
    }
    input::from_bundle(&bundle.machine)
        .map_err(|error| bundle.locate(error.under("machine")).into())
}

/// The runs of a bundle, but for those left out by name. Their channels carry the columns that the
/// model has for them, and are in SI units.
///
/// # Errors
/// A run that cannot be read, a name that no run has, or invalid conditions.
pub fn runs(bundle: &Bundle, tree: &Value, left_out: &[String]) -> Result<Vec<Run>, Error> {
    let ids: Vec<&str> = bundle.runs.iter().map(|run| run.id.as_str()).collect();
    known_runs("--leave-out", left_out, &ids)?;
    let kept = bundle.runs.iter().enumerate();
    let kept = kept.filter(|(_, run)| !left_out.contains(&run.id));
    kept.map(|(i, run)| {
        let meanings = bundle.meanings(i, tree)?;
        let recording = recording::read(bundle, run, &meanings)
            .map_err(|reason| Error::unusable(&run.id, reason))?;
        let mut section = run.section.clone();
        if let Value::Object(section) = &mut section
            && !section.contains_key("speed_rpm")
        {
            section.insert("speed_rpm".into(), recording.speed_rpm.into());
        }
        let settings = input::run_settings(&section, tree)
            .map_err(|error| bundle.locate(error.under(format!("runs.{i}"))))?;
        Ok(Run {
            id: run.id.clone(),
            settings,
            speed_rpm: recording.speed_rpm,
            sample_rate: recording.sample_rate,
            is_timed: recording.is_timed,
            crank_angle: recording.crank_angle,
            channels: recording.channels,
        })
    })
    .collect()
}

/// Checks that each of `asked` is the id of a run.
///
/// # Errors
/// The first name that no run has, with the nearest name that a run has.
pub fn known_runs(option: &str, asked: &[String], ids: &[&str]) -> Result<(), Error> {
    let Some(unknown) = asked.iter().find(|id| !ids.contains(&id.as_str())) else {
        return Ok(());
    };
    let nearest = input::nearest(unknown, ids.iter().copied());
    let hint = nearest.map_or(".".into(), |near| format!("; did you mean {near}?"));
    Err(Error::Refused(format!(
        "{option} {unknown}: there is no such run{hint} The runs are {}.",
        ids.join(", ")
    )))
}
