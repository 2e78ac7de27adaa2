//! A model of the worn machine: which clearances are unknown, and whether the contact parameters are too.

use super::joint::Joint;
use crate::error::Error;
use crate::parameter::Parameter;
use crate::problem::Problem;
use crate::relation::{ClearJoint, Relation};
use input::paths;
use input::unit::{Dimension, Measure};
use serde_json::Value;

/// What of a contact is fitted where the relation alone does not explain the recordings.
const CONTACT: [&str; 3] = [
    "contact.stiffness",
    "contact.damping",
    "friction.coefficient",
];

/// A model of the worn machine.
#[derive(Clone, Debug)]
pub(super) struct Model {
    /// Indices of the joints whose clearance is unknown; the others are ideal.
    pub clear: Vec<usize>,
    /// Whether the contact parameters of these joints are fitted too.
    pub contacts: bool,
    /// The machine with these parameters: a clearance per joint first.
    pub problem: Problem,
}

impl Model {
    /// The model in which the joints of these indices have an unknown clearance. `healthy` has the runs, and what else is
    /// unknown.
    ///
    /// # Errors
    /// A joint that cannot be clear.
    pub fn new(
        healthy: &Problem,
        joints: &[Joint],
        clear: Vec<usize>,
        contacts: bool,
    ) -> Result<Self, Error> {
        let mut problem = healthy.clone();
        for i in &clear {
            let joint = &joints[*i];
            if joint.stated.is_none() {
                let path = joint.clearance_path();
                paths::set(&mut problem.tree, &path, length(joint.start()))?;
            }
        }
        set_relation(&mut problem.tree)?;
        let mut parameters = Vec::new();
        for i in &clear {
            let path = joints[*i].clearance_path();
            parameters.push(Parameter::within(&problem.tree, &path, joints[*i].bounds)?);
        }
        for (i, key) in clear.iter().flat_map(|i| CONTACT.map(|key| (*i, key))) {
            let path = format!("{}.{key}", joints[i].path);
            // A joint may be without friction.
            if contacts && let Ok(parameter) = Parameter::of(&problem.tree, &path) {
                parameters.push(parameter);
            }
        }
        parameters.extend(healthy.parameters.iter().cloned());
        problem.parameters = parameters;
        Ok(Self {
            clear,
            contacts,
            problem,
        })
    }

    /// The coordinates of this model with the values of another at its coordinates `x`; 0 for what that does not have.
    pub fn coordinates_of(&self, other: &Self, x: &[f64]) -> Vec<f64> {
        let parameters = self.problem.parameters.iter();
        let of = |parameter: &Parameter| {
            let mut others = other.problem.parameters.iter().zip(x);
            let same = others.find(|(theirs, _)| theirs.path == parameter.path);
            same.map_or(0.0, |(theirs, x)| parameter.coordinate(theirs.value(*x)))
        };
        parameters.map(of).collect()
    }
}

/// Gives bearings that have no relation between clearances that of Eq. (5), as a calibration does.
fn set_relation(tree: &mut Value) -> Result<(), Error> {
    let bearings = ClearJoint::in_runs(tree, [&[][..]].into_iter())?;
    let mut silent = Vec::new();
    for bearing in bearings {
        if bearing.relation(tree)?.is_none() {
            silent.push(bearing);
        }
    }
    Relation::Equation5.set(tree, &silent)
}

/// A length as a machine file has it.
fn length(si: f64) -> Value {
    let dimension = Dimension::of(1.0, 0.0, 0.0, 0.0);
    Measure { si, dimension }.to_string().into()
}
