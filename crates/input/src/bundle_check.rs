//! Everything that can be wrong in a `recordings.yaml`, before any recording is read.

use crate::bundle::{ANY_SPEED, Bundle};
use crate::bundle_channel::Meaning;
use crate::bundle_machine::from_bundle;
use crate::error::{Error, Problem};
use crate::machine_file::{MachineFile, Resolved, synonyms};
use crate::paths;
use crate::run_settings::run_settings;
use crate::schema::bundle_schema;
use crate::yaml::Document;
use serde_json::Value;
use std::path::Path;

/// Checks the bundle in `folder` whose `recordings.yaml` has the content `document`: its machine section at the
/// conditions of each run, the channels, and where the recordings are.
///
/// # Errors
/// All mistakes, with their lines.
pub fn check(folder: &Path, document: &Document) -> Result<(), Error> {
    document.collect(bundle_schema, |tree| {
        let bundle = Bundle::new(folder, Document::from_tree(tree.clone()))?;
        let machine = match &bundle.machine {
            Value::Null => None,
            section => Some(from_bundle(section).map_err(|e| e.under("machine"))?),
        };
        for (i, run) in bundle.runs.iter().enumerate() {
            let key = format!("runs.{i}");
            let meanings = bundle.meanings(i, machine.as_ref().unwrap_or(&Value::Null))?;
            if let Some(machine) = &machine {
                let name = |key: &str| match key.strip_prefix("machine.") {
                    Some(own) => format!("machine.{}", synonyms::as_written(&bundle.machine, own)),
                    None => key.to_owned(),
                };
                at_run(machine, &with_speed(&run.section, &meanings), &key)
                    .map_err(|error| error.renamed(&name))?;
            }
            for file in 0..run.recordings().count() {
                bundle.path_of_file(run, file)?;
            }
        }
        Ok(())
    })
}

/// The machine of the bundle at the conditions of run `index`; none where the bundle has no machine.
///
/// # Errors
/// What makes the machine invalid, with the lines.
pub fn machine_of_run(bundle: &Bundle, index: usize) -> Result<Option<Resolved>, Error> {
    if bundle.machine.is_null() {
        return Ok(None);
    }
    let of_run = || {
        let machine = from_bundle(&bundle.machine).map_err(|e| e.under("machine"))?;
        let run = with_speed(
            &bundle.runs[index].section,
            &bundle.meanings(index, &machine)?,
        );
        at_run(&machine, &run, &format!("runs.{index}"))
    };
    of_run().map(Some).map_err(|error| bundle.locate(error))
}

/// A run with any speed in the place of one that its crank angle gives.
fn with_speed(run: &Value, channels: &[Meaning]) -> Value {
    let mut run = run.clone();
    let turns = |m: &Meaning| matches!(m, Meaning::CrankAngle(_) | Meaning::Tacho { .. });
    if let Value::Object(section) = &mut run
        && channels.iter().any(turns)
    {
        section.entry("speed_rpm").or_insert(ANY_SPEED.into());
    }
    run
}

/// The machine at the conditions of the run at `key`. What a run sets, or should, is wrong in the run.
fn at_run(machine: &Value, run: &Value, key: &str) -> Result<Resolved, Error> {
    let settings = run_settings(run, machine).map_err(|e| e.under(key))?;
    let mut conditions = machine.clone();
    let mut set = Vec::new();
    for (path, value) in &settings {
        paths::set(&mut conditions, path, value.clone()).map_err(|e| e.under(key))?;
        set.push(paths::keys(&conditions, path)?.join("."));
    }
    let resolved = MachineFile::from_tree(&conditions).and_then(|file| file.resolve());
    let in_bundle = |error: Error| {
        let is_set = set.iter().any(|path| path == error.key());
        let is_missing = matches!(error.problem(), Problem::Missing { .. });
        match key_of_run(&conditions, error.key()).filter(|_| is_set || is_missing) {
            Some(own) => in_run(&error, &own, key, &conditions),
            None => error.under("machine"),
        }
    };
    resolved.map_err(|errors| {
        let first = errors.clone();
        Error::all(errors.into_each().into_iter().map(in_bundle)).unwrap_or(first)
    })
}

/// The mistake of a machine at the key `own` of the run at `key`, which sets the value.
fn in_run(error: &Error, own: &str, key: &str, machine: &Value) -> Error {
    let own = format!("{key}.{own}");
    let moved = match error.problem() {
        Problem::Found { expected, .. } => Error::clash(own, expected),
        problem => Error::new(own, problem.clone()),
    };
    error.partners().fold(moved, |moved, partner| {
        moved.against(match key_of_run(machine, partner) {
            Some(other) => format!("/{key}.{other}"),
            None => format!("/machine.{partner}"),
        })
    })
}

/// The key of a run that sets `path` of its machine.
fn key_of_run(machine: &Value, path: &str) -> Option<String> {
    let (throw, rest) = match path
        .strip_prefix("throws.")
        .and_then(|rest| rest.split_once('.'))
    {
        Some((index, rest)) => {
            let throw = &machine["throws"][index.parse::<usize>().ok()?];
            (throw["name"].as_str()?, rest)
        }
        None => ("", path),
    };
    let of_throw = |section: &str, key: &str| {
        let parts = [section, throw, key]
            .into_iter()
            .filter(|part| !part.is_empty());
        Some(parts.collect::<Vec<_>>().join("."))
    };
    match rest.split('.').collect::<Vec<_>>()[..] {
        ["speed"] => Some("speed_rpm".to_owned()),
        ["cylinder", "suction"] => of_throw("load", "suction_pressure_pa"),
        ["cylinder", "discharge"] => of_throw("load", "discharge_pressure_pa"),
        ["joints", joint, "clearance"] => of_throw("joints", &format!("{joint}.clearance_m")),
        _ => None,
    }
}
