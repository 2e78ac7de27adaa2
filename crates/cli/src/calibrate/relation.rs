//! `--relation`: how contact parameters follow the clearance.

use super::Arguments;
use crate::Failure;
use ::calibrate::relation::{clearances, exponents, several};
use ::calibrate::{ClearJoint, Parameter, Problem, Relation, Run};
use clap::ValueEnum;
use serde_json::{Map, Value, json};

/// A relation by its name.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Name {
    /// Stiffness by Eq. (5) of the papers, damping with the patch of contact
    Eq5,
    /// Stiffness by the conformal form of Hertz's formula, the restitution stays
    Conformal,
    /// Nothing follows the clearance
    Constant,
    /// Powers of the clearance that the recordings tell
    Fitted,
}

impl Name {
    fn relation(self) -> Relation {
        match self {
            Self::Eq5 => Relation::Equation5,
            Self::Conformal => Relation::Conformal,
            Self::Constant => Relation::Constant,
            Self::Fitted => Relation::Fitted,
        }
    }
}

/// Gives every clear joint of the machine its relation, and returns the exponents to be fitted.
///
/// It is that of `--relation`. Without one the machine file says. Where the bundle's own machine
/// section says nothing, it is Eq. (5), unless the fitted runs have several clearances and so can
/// tell: then its exponents are fitted.
///
/// # Errors
/// A clearance that is no length.
pub fn set(
    arguments: &Arguments,
    tree: &mut Value,
    runs: &[Run],
    held_out: &[String],
) -> Result<Vec<Parameter>, Failure> {
    let settings = runs.iter().map(|run| &run.settings[..]);
    let joints = ClearJoint::of(tree, settings).map_err(Failure::input)?;
    let mut silent = Vec::new();
    for joint in &joints {
        if joint.relation(tree).map_err(Failure::input)?.is_none() {
            silent.push(joint.clone());
        }
    }
    let fitted = runs.iter().filter(|run| !held_out.contains(&run.id));
    let states = fitted.map(|run| clearances(tree, &joints, &run.settings));
    let states: Vec<_> = states.collect::<Result<_, _>>().map_err(Failure::input)?;
    let (relation, joints) = match (arguments.relation, &arguments.machine) {
        (Some(name), _) => (name.relation(), joints),
        (None, Some(_)) => return Ok(Vec::new()),
        (None, None) if several(&states) => (Relation::Fitted, silent),
        (None, None) => (Relation::Equation5, silent),
    };
    relation.set(tree, &joints).map_err(Failure::input)?;
    if relation == Relation::Fitted && !joints.is_empty() {
        return exponents(tree).map_err(Failure::input);
    }
    Ok(Vec::new())
}

/// What `calibration.json` says of the relation: its name as asked for, and for each clear joint the
/// relation and the clearance from which it leads.
///
/// # Errors
/// A machine that does not have what was fitted.
pub fn stated(arguments: &Arguments, problem: &Problem) -> Result<Value, Failure> {
    let settings = problem.runs.iter().map(|run| &run.settings[..]);
    let mut by_joint = Map::new();
    for joint in ClearJoint::of(&problem.tree, settings).map_err(Failure::work)? {
        let content = json!({
            "relation": joint.relation(&problem.tree).map_err(Failure::work)?,
            "at_clearance_m": joint.at_clearance(&problem.tree).map_err(Failure::work)?,
        });
        by_joint.insert(joint.path, content);
    }
    let asked = arguments.relation.map(|name| name.relation().name());
    Ok(json!({"asked": asked, "joints": by_joint}))
}
