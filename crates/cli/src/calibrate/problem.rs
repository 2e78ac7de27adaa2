//! From a bundle of recordings to what is to be fitted to what.

use super::{Arguments, relation};
use crate::{Failure, bundle};
use ::calibrate::problem::columns;
use ::calibrate::relation::clearances;
use ::calibrate::{ClearJoint, Observation, Parameter, Problem, Run};
use input::bundle::Bundle;
use input::{MachineFile, paths};
use serde_json::Value;

/// Of so many runs one is held out.
const HELD_OUT: usize = 4;

/// The problem that the arguments state of this bundle, and the runs that are held out of the fit.
///
/// # Errors
/// A machine or run that cannot be used, or a path that the machine does not have.
pub fn problem(arguments: &Arguments, bundle: &Bundle) -> Result<(Problem, Vec<String>), Failure> {
    let mut tree = bundle::machine(bundle, arguments.machine.as_deref())?;
    let runs = bundle::runs(bundle, &tree, &arguments.leave_out)?;
    let Some(first) = runs.first() else {
        return Err(Failure::input("every run is left out"));
    };
    // The machine stands at the conditions of the first run where it has none of its own.
    for (path, value) in &first.settings {
        paths::set(&mut tree, path, value.clone())?;
    }
    let held_out = held_out(arguments, &tree, &runs)?;
    let exponents = relation::set(arguments, &mut tree, &runs, &held_out)?;
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
    let mut parameters = fitted
        .iter()
        .map(|path| Parameter::of(&tree, path))
        .collect::<Result<Vec<_>, _>>()
        .map_err(Failure::input)?;
    parameters.extend(exponents);
    let runs = runs
        .iter()
        .map(|run| Observation::of(run, &columns))
        .collect::<Result<_, _>>()
        .map_err(Failure::input)?;
    let problem = Problem {
        tree,
        parameters,
        runs,
    };
    Ok((problem, held_out))
}

/// The runs to be predicted: those asked for, else of every four the last whose clearances a run has
/// that is fitted.
fn held_out(arguments: &Arguments, tree: &Value, runs: &[Run]) -> Result<Vec<String>, Failure> {
    let ids: Vec<&str> = runs.iter().map(|run| run.id.as_str()).collect();
    bundle::known_runs("--hold-out", &arguments.hold_out, &ids)?;
    if !arguments.hold_out.is_empty() {
        return Ok(arguments.hold_out.clone());
    }
    let settings = runs.iter().map(|run| &run.settings[..]);
    let joints = ClearJoint::of(tree, settings).map_err(Failure::input)?;
    let states = runs.iter().map(|r| clearances(tree, &joints, &r.settings));
    let states: Vec<_> = states.collect::<Result<_, _>>().map_err(Failure::input)?;
    let mut held_out: Vec<usize> = Vec::new();
    for last in (HELD_OUT - 1..runs.len()).step_by(HELD_OUT) {
        let shared = |i: &usize| {
            (0..runs.len()).any(|j| j != *i && states[j] == states[*i] && !held_out.contains(&j))
        };
        let group = last + 1 - HELD_OUT..=last;
        held_out.extend(group.rev().find(shared));
    }
    Ok(held_out.into_iter().map(|i| runs[i].id.clone()).collect())
}
