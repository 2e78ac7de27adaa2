//! What can be wrong in calibration.yaml before any machine and any recording is read.

use crate::run_condition::{ANGLE, CRANK_ANGLE_OFFSET};
use input::amount::Amount;
use input::calibration::Calibration;
use input::unit::Dimension;
use input::{Error, Problem, paths};
use serde_json::Value;

/// Checks the paths of the parameters, and the units of their bounds, against the format of machine files. `tree` is
/// the content of the settings file.
///
/// # Errors
/// All mistakes; keys are those of the file.
pub fn check_settings(settings: &Calibration, tree: &Value) -> Result<(), Error> {
    let are_listed = tree["parameters"].is_array();
    let parameters = settings.parameters.0.iter().enumerate();
    let wrong = parameters.filter_map(|(i, (path, bounds))| {
        let key = match are_listed {
            true => format!("parameters.{i}"),
            false => format!("parameters.{path}"),
        };
        check(path, bounds.as_ref(), &key).err()
    });
    Error::all(wrong).map_or(Ok(()), Err)
}

/// Checks the parameter `path` at `key`.
fn check(path: &str, bounds: Option<&[Amount; 2]>, key: &str) -> Result<(), Error> {
    let (expected, dimension) = match of_machine(path) {
        CRANK_ANGLE_OFFSET => (
            "an angle with its unit, e.g. '1 deg'".to_owned(),
            Some(ANGLE),
        ),
        path => match paths::expected(path) {
            Ok(None) => return Ok(()),
            Ok(Some((words, example))) => (words, example.dimension),
            // The item of a list does not show which part of the path is wrong.
            Err(error) if key.ends_with(path) => {
                return Err(Error::new(key, error.problem().clone()));
            }
            Err(error) => {
                let words = format!("{}: {}", error.key(), error.problem());
                return Err(Error::new(key, Problem::Other(words)));
            }
        },
    };
    let wrong = bounds
        .into_iter()
        .flatten()
        .position(|b| !is_of_kind(b.dimension, dimension));
    match wrong {
        Some(i) => Err(Error::clash(format!("{key}.bounds.{i}"), expected)),
        None => Ok(()),
    }
}

/// The path without the run that it belongs to. The name of a run may have dots in it.
fn of_machine(path: &str) -> &str {
    let Some(of_runs) = path.strip_prefix("runs.") else {
        return path;
    };
    let rests = of_runs.match_indices('.').map(|(at, _)| &of_runs[at + 1..]);
    let is_path = |rest: &&str| *rest == CRANK_ANGLE_OFFSET || paths::expected(rest).is_ok();
    rests
        .clone()
        .find(is_path)
        .or_else(|| rests.clone().next())
        .unwrap_or(path)
}

/// Whether a bound may be one of a value of this dimension; that of a contact stiffness follows its exponent.
fn is_of_kind(bound: Option<Dimension>, value: Option<Dimension>) -> bool {
    let is_stiffness = |d: Option<Dimension>| d.is_some_and(|d| d.stiffness_exponent().is_some());
    bound == value || is_stiffness(bound) && is_stiffness(value)
}
