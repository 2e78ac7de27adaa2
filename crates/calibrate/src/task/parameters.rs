//! Which parameters are fitted.

use super::settings::Settings;
use crate::error::Error;
use crate::observation::Run;
use crate::parameter::Parameter;
use crate::relation::ClearJoint;
use crate::run_condition::CRANK_ANGLE_OFFSET;
use crate::shut_valve::{ShutValve, Valve};
use input::unit::Dimension;
use serde_json::Value;
use std::collections::BTreeSet;

/// What is fitted: the paths of the settings, else the contact of the joints that are clear.
///
/// # Errors
/// A path that cannot be fitted, or bounds that are not of its unit.
pub(super) fn fitted(
    settings: &Settings,
    tree: &Value,
    runs: &[Run],
) -> Result<Vec<Parameter>, Error> {
    let asked = &settings.calibration.parameters.0;
    let refuse = |path: &str, reason: String| {
        let key = format!("parameters.{path}");
        Error::from((settings.locate)(input::Error::new(
            key,
            input::Problem::Other(reason),
        )))
    };
    let of = |path: &str, bounds: Option<[f64; 2]>| {
        Parameter::named(tree, runs, path, bounds).map_err(|e| refuse(path, e.to_string()))
    };
    if asked.is_empty() {
        let defaults = defaults(tree, runs)?;
        let mut parameters = Vec::new();
        for path in &defaults {
            let mut parameter = of(path, None)?;
            with_equal_lines(runs, &mut parameter);
            parameters.push(parameter);
        }
        return Ok(parameters);
    }
    let mut parameters: Vec<Parameter> = Vec::new();
    for (path, bounds) in asked {
        let parameter = of(path, bounds.map(|bounds| bounds.map(|b| b.si)))?;
        if let Some([low, _]) = bounds
            && low.dimension != parameter.dimension
        {
            let unit = parameter
                .dimension
                .as_ref()
                .map_or("none".to_owned(), Dimension::to_string);
            let reason = format!("the bounds have another unit than its value ({unit})");
            return Err(refuse(path, reason));
        }
        if parameters.iter().any(|p| p.path == *path) {
            return Err(refuse(path, "it is named twice".into()));
        }
        parameters.push(parameter);
    }
    // The zero of the encoder belongs to the recordings, not to the machine. An encoder's last digit matters for all
    // parameters. A bound of its own holds it where it is known.
    let has_offset = parameters.iter().any(Parameter::is_crank_angle_offset);
    if !has_offset && !are_pressures_alone(runs) {
        parameters.push(of(CRANK_ANGLE_OFFSET, None)?);
    }
    Ok(parameters)
}

fn are_pressures_alone(runs: &[Run]) -> bool {
    let mut columns = runs.iter().flat_map(|run| &run.channels).map(|c| &c.column);
    columns.all(|column| column.contains("cylinder_pressure"))
}

/// What is fitted by default. It is the contact of the joints that are clear, and the zero of the crank angle, of which
/// an encoder's last digit already matters. If only pressures were recorded, it is the gas.
/// A joint that no run mentions has the clearance that the machine file states.
fn defaults(tree: &Value, runs: &[Run]) -> Result<Vec<String>, Error> {
    if are_pressures_alone(runs) {
        return Ok(gas_defaults(runs));
    }
    let clear = |(path, value): &&(String, Value)| path.ends_with(".clearance") && value != "ideal";
    let settings = runs.iter().flat_map(|run| &run.settings).filter(clear);
    let mut joints: Vec<String> = settings
        .map(|(path, _)| path.trim_end_matches(".clearance").to_owned())
        .collect();
    let of_runs = runs.iter().map(|run| &run.settings[..]);
    let of_machine = ClearJoint::in_runs(tree, of_runs)?;
    joints.extend(of_machine.into_iter().map(|joint| joint.path));
    joints.sort_unstable();
    joints.dedup();
    let keys = [
        "contact.stiffness",
        "contact.damping",
        "friction.coefficient",
    ];
    let of_joint = |joint: &String| keys.map(|key| format!("{joint}.{key}"));
    let contacts = joints.iter().flat_map(of_joint);
    Ok(contacts.chain([CRANK_ANGLE_OFFSET.to_owned()]).collect())
}

/// The exponent and the clearance of every chamber with a pressure, and the pressures of the lines
/// in each run. Lines of the same pressure have one value.
fn gas_defaults(runs: &[Run]) -> Vec<String> {
    let mut paths = BTreeSet::new();
    for run in runs {
        for channel in &run.channels {
            let throw = throw(&channel.column);
            let clearance = match channel.column.contains("crank_end") {
                true => "crank_end.clearance",
                false => "head_clearance",
            };
            for value in ["exponent", clearance] {
                paths.insert(format!("{throw}cylinder.{value}"));
            }
            paths.insert(line(run, &throw, Valve::Suction));
            if !has_equal_lines(run, &throw) {
                paths.insert(line(run, &throw, Valve::Discharge));
            }
        }
    }
    paths.into_iter().collect()
}

/// Gives the suction pressure of a machine that is motored to its discharge line as well: the valves between them are
/// open, and one cannot be above the other.
fn with_equal_lines(runs: &[Run], parameter: &mut Parameter) {
    for run in runs {
        for channel in &run.channels {
            let throw = throw(&channel.column);
            let is_suction = parameter.path == line(run, &throw, Valve::Suction);
            let discharge = format!("{throw}cylinder.discharge");
            if is_suction && has_equal_lines(run, &throw) && !parameter.places.contains(&discharge)
            {
                parameter.places.push(discharge);
            }
        }
    }
}

/// Whether suction and discharge line of a throw are stated to have the same pressure.
fn has_equal_lines(run: &Run, throw: &str) -> bool {
    let stated = |line: &str| {
        let path = format!("{throw}cylinder.{line}");
        let mut settings = run.settings.iter();
        settings
            .find(|(own, _)| *own == path)
            .map(|(_, value)| value)
    };
    stated("suction").is_some_and(|suction| stated("discharge") == Some(suction))
}

/// The section of the throw that a column names.
fn throw(column: &str) -> String {
    let throw = column.split_once('.').map(|(throw, _)| throw);
    throw.map_or_else(String::new, |throw| format!("throws.{throw}."))
}

/// The pressure of a line in a run.
fn line(run: &Run, throw: &str, valve: Valve) -> String {
    format!("runs.{}.{throw}cylinder.{}", run.id, valve.name())
}

/// The discharge lines to which no chamber opens its valve in a run: the recording does not show their pressure. The suction
/// pressure is fitted even so, as it is that of the gas which the chamber holds when it is largest.
pub(super) fn unseen_lines(runs: &[Run], shut: &[ShutValve]) -> Vec<String> {
    let (mut unseen, mut seen) = (BTreeSet::new(), BTreeSet::new());
    for run in runs {
        for channel in &run.channels {
            let is_it = |one: &ShutValve| {
                one.run == run.id && one.channel == channel.column && one.valve == Valve::Discharge
            };
            let path = line(run, &throw(&channel.column), Valve::Discharge);
            match shut.iter().any(is_it) {
                true => unseen.insert(path),
                false => seen.insert(path),
            };
        }
    }
    unseen.difference(&seen).cloned().collect()
}
