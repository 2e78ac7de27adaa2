//! From a bundle of recordings to what is to be fitted to what.

use super::Arguments;
use crate::{Failure, bundle};
use ::calibrate::problem::columns;
use ::calibrate::{Observation, Parameter, Problem};
use input::bundle::Bundle;
use input::{MachineFile, paths};
use serde_json::Value;

/// One run in so many is held out.
const HELD_OUT: usize = 4;

/// The problem that the arguments state of this bundle.
///
/// # Errors
/// A machine or run that cannot be used, or a path that the machine does not have.
pub fn problem(arguments: &Arguments, bundle: &Bundle) -> Result<Problem, Failure> {
    let mut tree = bundle::machine(bundle, arguments.machine.as_deref())?;
    let runs = bundle::runs(bundle, &tree, &arguments.leave_out)?;
    let Some(first) = runs.first() else {
        return Err(Failure::input("every run is left out"));
    };
    // The machine stands at the conditions of the first run where it has none of its own.
    for (path, value) in &first.settings {
        paths::set(&mut tree, path, value.clone())?;
    }
    let machine = MachineFile::from_tree(&tree)?.resolve()?;
    let columns = columns(&machine);
    let clear = |path: &String, value: &Value| path.ends_with(".clearance") && value != "ideal";
    let mut fitted = arguments.parameter.clone();
    if fitted.is_empty() {
        let mut joints: Vec<&str> = runs
            .iter()
            .flat_map(|run| &run.settings)
            .filter(|(path, value)| clear(path, value))
            .map(|(path, _)| path.trim_end_matches(".clearance"))
            .collect();
        joints.sort_unstable();
        joints.dedup();
        fitted = joints
            .iter()
            .flat_map(|joint| {
                [
                    "contact.stiffness",
                    "contact.damping",
                    "friction.coefficient",
                ]
                .map(|key| format!("{joint}.{key}"))
            })
            .collect();
    }
    let parameters = fitted
        .iter()
        .map(|path| Parameter::of(&tree, path))
        .collect::<Result<_, _>>()
        .map_err(Failure::input)?;
    let runs = runs
        .iter()
        .map(|run| Observation::of(run, &columns))
        .collect::<Result<_, _>>()
        .map_err(Failure::input)?;
    Ok(Problem {
        tree,
        parameters,
        runs,
    })
}

/// The runs to be predicted: those asked for, else every fourth.
///
/// # Errors
/// A name that no run has.
pub fn held_out(arguments: &Arguments, problem: &Problem) -> Result<Vec<String>, Failure> {
    let ids: Vec<&str> = problem.runs.iter().map(|run| run.id.as_str()).collect();
    bundle::known_runs("--hold-out", &arguments.hold_out, &ids)?;
    if !arguments.hold_out.is_empty() {
        return Ok(arguments.hold_out.clone());
    }
    let each = ids.iter().skip(HELD_OUT - 1).step_by(HELD_OUT);
    Ok(each.map(|id| (*id).to_owned()).collect())
}
