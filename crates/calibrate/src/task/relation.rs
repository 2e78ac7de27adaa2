//! How contact parameters follow the clearance: `--relation`, or what stands in for it.

use super::settings::Settings;
use crate::error::Error;
use crate::observation::Run;
use crate::parameter::Parameter;
use crate::relation::{ClearJoint, Relation, clearances, exponents, several};
use input::calibration;
use serde_json::Value;

/// Gives every clear joint of the machine its relation, and returns the exponents to be fitted.
///
/// 1. The relation of the settings.
/// 2. Without one, that of the machine file.
/// 3. Where the bundle's own machine section has no relation: fitted exponents if the fitted runs have several
///    clearances, else Eq. (5).
///
/// # Errors
/// A clearance that is no length.
pub(super) fn set(
    settings: &Settings,
    tree: &mut Value,
    runs: &[Run],
    held_out: &[String],
) -> Result<Vec<Parameter>, Error> {
    let of_runs = runs.iter().map(|run| &run.settings[..]);
    let joints = ClearJoint::in_runs(tree, of_runs)?;
    let mut silent = Vec::new();
    for joint in &joints {
        if joint.relation(tree)?.is_none() {
            silent.push(joint.clone());
        }
    }
    let fitted = runs.iter().filter(|run| !held_out.contains(&run.id));
    let states = fitted.map(|run| clearances(tree, &joints, &run.settings));
    let states: Vec<_> = states.collect::<Result<_, _>>()?;
    let asked = settings.calibration;
    let (relation, joints) = match (asked.relation, settings.has_machine_file()) {
        (Some(asked), _) => (named(asked), joints),
        (None, true) => return Ok(Vec::new()),
        (None, false) if several(&states) => (Relation::Fitted, silent),
        (None, false) => (Relation::Equation5, silent),
    };
    relation.set(tree, &joints)?;
    if relation == Relation::Fitted && !joints.is_empty() {
        return exponents(tree);
    }
    Ok(Vec::new())
}

fn named(asked: calibration::Relation) -> Relation {
    match asked {
        calibration::Relation::Eq5 => Relation::Equation5,
        calibration::Relation::Conformal => Relation::Conformal,
        calibration::Relation::Constant => Relation::Constant,
        calibration::Relation::Fitted => Relation::Fitted,
    }
}
