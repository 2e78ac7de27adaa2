//! A model of the worn machine: which clearances are unknown, and what is unknown of the contacts.

use super::joint::Joint;
use crate::error::Error;
use crate::parameter::{Parameter, Scale};
use crate::prior::{DESIGN, Prior};
use crate::problem::Problem;
use crate::relation::{self, ClearJoint, Relation};
use input::paths;
use input::unit::{Dimension, Measure};
use serde_json::Value;

/// What of a contact is fitted where the relation alone does not explain the recordings.
const CONTACT: [&str; 3] = [
    "contact.stiffness",
    "contact.damping",
    "friction.coefficient",
];
/// Standard deviation of an exponent of the clearance before the recordings are looked at: the known relations differ by 0.2 in
/// that of the damping.
const EXPONENT: f64 = 0.2;

/// What is unknown of the contacts of clear joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Contacts {
    /// Nothing: their parameters follow the clearance by the relation of the machine file.
    Stated,
    /// By which exponents stiffness and damping follow the clearance.
    Related,
    /// Each of their parameters.
    Fitted,
}

/// A model of the worn machine.
#[derive(Clone, Debug)]
pub(super) struct Model {
    /// Indices of the joints whose clearance is unknown; the others are ideal.
    pub clear: Vec<usize>,
    /// What is unknown of the contacts of these joints.
    pub contacts: Contacts,
    /// What is known of it before.
    pub priors: Vec<Prior>,
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
        contacts: Contacts,
    ) -> Result<Self, Error> {
        let mut problem = healthy.clone();
        for i in &clear {
            let joint = &joints[*i];
            if joint.stated.is_none() {
                let path = joint.clearance_path();
                paths::set(&mut problem.tree, &path, length(joint.start()))?;
            }
        }
        let bearings = set_relation(&mut problem.tree)?;
        let mut parameters = Vec::new();
        for i in &clear {
            let path = joints[*i].clearance_path();
            parameters.push(Parameter::within(&problem.tree, &path, joints[*i].bounds)?);
        }
        match contacts {
            Contacts::Stated => {}
            Contacts::Related => {
                relation::set_powers(&mut problem.tree, &bearings)?;
                parameters.extend(relation::exponents_of(&problem.tree, &bearings)?);
            }
            Contacts::Fitted => {
                parameters.extend(contact_parameters(&problem.tree, joints, &clear));
            }
        }
        let priors = parameters.iter().enumerate().skip(clear.len());
        let priors = priors.map(|(place, parameter)| Prior {
            place,
            spread: match parameter.scale {
                Scale::Logarithmic => DESIGN,
                Scale::Linear => parameter.coordinate(parameter.nominal + EXPONENT),
            },
        });
        let priors = priors.collect();
        parameters.extend(healthy.parameters.iter().cloned());
        problem.parameters = parameters;
        Ok(Self {
            clear,
            contacts,
            priors,
            problem,
        })
    }

    /// The coordinates of this model with the values of another at its coordinates `x`; 0 for what that does not have. Contact
    /// parameters are those that the exponents of the other lead to.
    pub fn coordinates_of(&self, other: &Self, x: &[f64]) -> Vec<f64> {
        let parameters = self.problem.parameters.iter();
        let of = |parameter: &Parameter| {
            let mut others = other.problem.parameters.iter().zip(x);
            let same = others.find(|(theirs, _)| theirs.path == parameter.path);
            match same {
                Some((theirs, x)) => parameter.coordinate(theirs.value(*x)),
                None => other.moved(&parameter.path, x).unwrap_or(0.0),
            }
        };
        parameters.map(of).collect()
    }

    /// By how much the logarithm of the contact parameter at `path` differs, at the coordinates `x`, from that by the relation
    /// of the machine file; none where no exponent says so.
    fn moved(&self, path: &str, x: &[f64]) -> Option<f64> {
        let (joint, key) = path.split_once(".contact.")?;
        let place = format!("{joint}.contact.relation.{key}");
        let mut parameters = self.problem.parameters.iter().zip(x);
        let (exponent, x_of_exponent) = parameters.find(|(p, _)| p.places.contains(&place))?;
        let clearance = format!("{joint}.clearance");
        let mut parameters = self.problem.parameters.iter().zip(x);
        let (clearance, x_of_clearance) = parameters.find(|(p, _)| p.path == clearance)?;
        let from = relation::at_clearance(&self.problem.tree, joint).ok()??;
        let change = exponent.value(*x_of_exponent) - exponent.nominal;
        Some(change * (clearance.value(*x_of_clearance) / from).ln())
    }

    /// The problem with the contact parameters of the machine file free as well, where they are not: within this share of their
    /// values. They come last.
    pub fn with_tolerance(&self, joints: &[Joint], share: f64) -> Problem {
        let mut problem = self.problem.clone();
        if self.contacts != Contacts::Fitted {
            let all = contact_parameters(&problem.tree, joints, &self.clear);
            problem.parameters.extend(all.map(|mut parameter| {
                parameter.bounds = [1.0 - share, 1.0 + share].map(|of| of * parameter.nominal);
                parameter
            }));
        }
        problem
    }
}

/// The contact parameters of the clear joints; a joint may be without friction.
fn contact_parameters(
    tree: &Value,
    joints: &[Joint],
    clear: &[usize],
) -> impl Iterator<Item = Parameter> {
    let paths = clear.iter().flat_map(move |i| {
        let joint = &joints[*i].path;
        CONTACT.map(|key| format!("{joint}.{key}"))
    });
    paths.filter_map(move |path| Parameter::at(tree, &path).ok())
}

/// Gives bearings that have no relation between clearances that of Eq. (5), as a calibration does, and returns all bearings.
fn set_relation(tree: &mut Value) -> Result<Vec<ClearJoint>, Error> {
    let bearings = ClearJoint::in_runs(tree, [&[][..]].into_iter())?;
    let mut silent = Vec::new();
    for bearing in &bearings {
        if bearing.relation(tree)?.is_none() {
            silent.push(bearing.clone());
        }
    }
    Relation::Equation5.set(tree, &silent)?;
    Ok(bearings)
}

/// A length as a machine file has it.
fn length(si: f64) -> Value {
    let dimension = Dimension::new(1.0, 0.0, 0.0, 0.0);
    Measure { si, dimension }.to_string().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crank_motion::CrankMotion;
    use crate::meter::Meter;
    use serde_json::json;
    use std::path::Path;

    const PATH: &str = "joints.big_end";

    /// A machine whose clear bearings have this relation at 0.05 mm.
    fn healthy(relation: &str) -> Problem {
        let file = format!(
            "{}/../../data/machines/single-stage.yaml",
            env!("CARGO_MANIFEST_DIR")
        );
        let file = input::machine_file::read(Path::new(&file)).unwrap();
        let mut tree = file.to_tree().clone();
        for joint in [PATH, "joints.small_end"] {
            for (key, value) in [("relation", relation), ("at_clearance", "0.05 mm")] {
                paths::set(&mut tree, &format!("{joint}.contact.{key}"), json!(value)).unwrap();
            }
        }
        Problem {
            tree,
            parameters: Vec::new(),
            runs: Vec::new(),
            crank: CrankMotion::Driven,
            meter: Meter::default(),
        }
    }

    fn model(healthy: &Problem, contacts: Contacts) -> Model {
        let joints = Joint::of_machine(&healthy.tree).unwrap();
        let place = joints.iter().position(|joint| joint.path == PATH);
        Model::new(healthy, &joints, vec![place.unwrap()], contacts).unwrap()
    }

    fn place(model: &Model, ends: &str) -> usize {
        let mut parameters = model.problem.parameters.iter();
        parameters.position(|p| p.path.ends_with(ends)).unwrap()
    }

    #[test]
    fn contact_parameters_are_those_that_the_exponents_lead_to() {
        let healthy = healthy("eq5");
        let related = model(&healthy, Contacts::Related);
        let fitted = model(&healthy, Contacts::Fitted);
        let mut x = vec![0.0; related.problem.parameters.len()];
        let clearance = &related.problem.parameters[0];
        x[0] = clearance.coordinate(2.5e-4);
        let damping = place(&related, "relation.damping");
        x[damping] = related.problem.parameters[damping].coordinate(-0.05);
        let y = fitted.coordinates_of(&related, &x);
        // From c^(-0.2) to c^(-0.05) at five times the clearance.
        let expected = 0.15 * 5.0_f64.ln();
        assert!((y[place(&fitted, "contact.damping")] - expected).abs() < 1e-12);
        assert_eq!(y[place(&fitted, "contact.stiffness")], 0.0);
        assert_eq!(y[place(&fitted, "friction.coefficient")], 0.0);
        let value = fitted.problem.parameters[0].value(y[0]);
        assert!((value - 2.5e-4).abs() < 1e-18);
    }

    #[test]
    fn an_exponent_is_known_to_two_tenths_before() {
        let related = model(&healthy("constant"), Contacts::Related);
        assert_eq!(related.priors.len(), 2);
        for prior in &related.priors {
            let exponent = &related.problem.parameters[prior.place];
            let change = exponent.value(prior.spread) - exponent.nominal;
            assert!((change - EXPONENT).abs() < 1e-12, "{prior:?}");
        }
    }
}
