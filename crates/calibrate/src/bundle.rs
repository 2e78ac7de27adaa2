//! A bundle of recordings becomes the runs that a machine is held against.

mod recording;

use crate::error::Error;
use crate::observation::Run;
use input::bundle::{self, Bundle};
use input::bundle_channel::{Meaning, meaning};
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
/// A run that cannot be read, a name that no run has, or conditions that are none.
pub fn runs(bundle: &Bundle, tree: &Value, left_out: &[String]) -> Result<Vec<Run>, Error> {
    let ids: Vec<&str> = bundle.runs.iter().map(|run| run.id.as_str()).collect();
    known_runs("--leave-out", left_out, &ids)?;
    let throws = throws(tree);
    let kept = bundle.runs.iter().enumerate();
    let kept = kept.filter(|(_, run)| !left_out.contains(&run.id));
    kept.map(|(i, run)| {
        let meanings = meanings(bundle, i, &throws)?;
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

/// What the channels of run `i` are, in their order.
///
/// # Errors
/// A channel whose unit or name is not understood.
pub fn meanings(bundle: &Bundle, i: usize, throws: &[String]) -> Result<Vec<Meaning>, Error> {
    let names: Vec<&str> = throws.iter().map(String::as_str).collect();
    let channels = bundle.runs[i].channels.iter().enumerate();
    channels
        .map(|(j, channel)| {
            meaning(channel, &names).map_err(|error| {
                let key = format!("runs.{i}.channels.{j}");
                bundle.locate(error.under(key)).into()
            })
        })
        .collect()
}

/// The names of a machine's throws; one without letters for a machine of one.
pub fn throws(tree: &Value) -> Vec<String> {
    let Some(throws) = tree["throws"].as_array() else {
        return vec![String::new()];
    };
    let names = throws.iter().map(|throw| throw["name"].as_str());
    names
        .map(|name| name.unwrap_or_default().to_owned())
        .collect()
}

/// Checks that each of `asked` is the id of a run.
///
/// # Errors
/// The first that is none, with the nearest that is.
pub fn known_runs(option: &str, asked: &[String], ids: &[&str]) -> Result<(), Error> {
    let Some(unknown) = asked.iter().find(|id| !ids.contains(&id.as_str())) else {
        return Ok(());
    };
    let nearest = input::nearest(unknown, ids.iter().copied());
    let hint = nearest.map_or(String::new(), |near| format!("; did you mean {near}?"));
    Err(Error::Refused(format!(
        "{option} {unknown}: there is no such run{hint} The runs are {}.",
        ids.join(", ")
    )))
}
