//! Which parameters are fitted.

use super::settings::Settings;
use crate::error::Error;
use crate::observation::Run;
use crate::parameter::Parameter;
use crate::relation::ClearJoint;
use crate::run_condition::CRANK_ANGLE_OFFSET;
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
        return defaults.iter().map(|path| of(path, None)).collect();
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
/// in each run.
fn gas_defaults(runs: &[Run]) -> Vec<String> {
    let mut paths = BTreeSet::new();
    for run in runs {
        for channel in &run.channels {
            let (throw, name) = match channel.column.split_once('.') {
                Some((throw, name)) => (format!("throws.{throw}."), name),
                None => (String::new(), channel.column.as_str()),
            };
            let clearance = match name.contains("crank_end") {
                true => "crank_end.clearance",
                false => "head_clearance",
            };
            for value in ["exponent", clearance] {
                paths.insert(format!("{throw}cylinder.{value}"));
            }
            for line in ["suction", "discharge"] {
                paths.insert(format!("runs.{}.{throw}cylinder.{line}", run.id));
            }
        }
    }
    paths.into_iter().collect()
}
