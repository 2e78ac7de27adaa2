//! How contact parameters follow the clearance: `--relation`, or what stands in for it.

use super::Settings;
use crate::Failure;
use ::calibrate::relation::{clearances, exponents, several};
use ::calibrate::{ClearJoint, Parameter, Problem, Relation, Run};
use input::calibration;
use serde_json::{Map, Value, json};

/// Gives every clear joint of the machine its relation, and returns the exponents to be fitted.
///
/// It is that of the settings. Without one the machine file says. Where the bundle's own machine
/// section says nothing, it is Eq. (5), unless the fitted runs have several clearances and so can
/// tell: then its exponents are fitted.
///
/// # Errors
/// A clearance that is no length.
pub fn set(
    settings: &Settings,
    tree: &mut Value,
    runs: &[Run],
    held_out: &[String],
) -> Result<Vec<Parameter>, Failure> {
    let of_runs = runs.iter().map(|run| &run.settings[..]);
    let joints = ClearJoint::of(tree, of_runs).map_err(Failure::input)?;
    let mut silent = Vec::new();
    for joint in &joints {
        if joint.relation(tree).map_err(Failure::input)?.is_none() {
            silent.push(joint.clone());
        }
    }
    let fitted = runs.iter().filter(|run| !held_out.contains(&run.id));
    let states = fitted.map(|run| clearances(tree, &joints, &run.settings));
    let states: Vec<_> = states.collect::<Result<_, _>>().map_err(Failure::input)?;
    let asked = settings.calibration;
    let (relation, joints) = match (asked.relation, settings.has_machine_file()) {
        (Some(asked), _) => (named(asked), joints),
        (None, true) => return Ok(Vec::new()),
        (None, false) if several(&states) => (Relation::Fitted, silent),
        (None, false) => (Relation::Equation5, silent),
    };
    relation.set(tree, &joints).map_err(Failure::input)?;
    if relation == Relation::Fitted && !joints.is_empty() {
        return exponents(tree).map_err(Failure::input);
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

/// The relations that a comparison does not exclude, as a machine file has them, and their weights.
pub(crate) fn not_excluded(relations: &Value) -> Vec<(Value, f64)> {
    let left = relations["decision"]["relations"].as_array();
    let Some(left) = left.filter(|left| !left.is_empty()) else {
        let named = Relation::ALL.iter().filter(|r| **r != Relation::Fitted);
        return named
            .map(|relation| (relation.name().into(), 1.0))
            .collect();
    };
    let compared = relations["compared"].as_array().into_iter().flatten();
    compared
        .filter(|compared| left.contains(&compared["relation"]))
        .map(|compared| {
            let above = compared["criterion"].as_f64().unwrap_or(0.0);
            let exponents = compared["exponents"].as_object();
            let exponents: Map<String, Value> = exponents
                .into_iter()
                .flatten()
                .filter_map(|(path, found)| {
                    let key = path.rsplit('.').next()?;
                    Some((key.to_owned(), found["value"].clone()))
                })
                .collect();
            let relation = match exponents.is_empty() {
                true => compared["relation"].clone(),
                false => exponents.into(),
            };
            (relation, scalar::elementary::exp(-0.5 * above))
        })
        .collect()
}

/// The same without weights, for bounds: fitted exponents stand there with each of them at either end
/// of its interval, too.
pub(crate) fn bounds_of_not_excluded(relations: &Value) -> Vec<Value> {
    let mut all = Vec::new();
    for (relation, _) in not_excluded(relations) {
        let compared = relations["compared"].as_array().into_iter().flatten();
        let intervals = compared.filter_map(|compared| compared["exponents"].as_object());
        let intervals = intervals.flatten().filter(|_| relation.is_object());
        let moved: Vec<Value> = intervals
            .flat_map(|(path, found)| {
                let key = path.rsplit('.').next().unwrap_or(path);
                let moved = |end: &str| {
                    let mut relation = relation.clone();
                    relation[key] = found[end].clone();
                    relation
                };
                ["low", "high"].map(moved)
            })
            .collect();
        all.push(relation);
        all.extend(moved);
    }
    all
}

/// What `calibration.json` says of it: for each clear joint the relation and the clearance from
/// which it leads, as the fit began with them; null where there is none. `clearance_m` is its
/// smallest clearance in the runs.
///
/// # Errors
/// A clearance that is no length.
pub fn stated(problem: &Problem) -> Result<Value, Failure> {
    let of_runs = problem.runs.iter().map(|run| &run.settings[..]);
    let mut by_joint = Map::new();
    for joint in ClearJoint::of(&problem.tree, of_runs).map_err(Failure::work)? {
        let content = json!({
            "relation": joint.relation(&problem.tree).map_err(Failure::work)?,
            "at_clearance_m": joint.at_clearance(&problem.tree).map_err(Failure::work)?,
            "clearance_m": joint.clearance,
        });
        by_joint.insert(joint.path, content);
    }
    Ok(by_joint.into())
}
