//! Effects that were tried and found, and values of the data sheet that were wrong.

use crate::amendment::candidate::Candidate;
use crate::criteria::Evidence;
use crate::model::Model;
use calibrate::Problem;
use serde::{Deserialize, Serialize};

/// An effect that was looked at.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The effect.
    pub candidate: Candidate,
    /// Its parameters, SI.
    pub values: Vec<f64>,
    /// How well it did.
    pub evidence: Evidence,
    /// Probability that it is what is there, 0 to 1.
    pub probability: f64,
    /// The model with it, fitted to some or all runs; none where its parameters are no model's.
    pub model: Option<Model>,
}

/// An effect that was added.
#[derive(Clone, Debug)]
pub struct Found {
    /// The effect as it was added, with the model with which that was decided.
    pub effect: Tried,
    /// The full model once it had been added; none where that was not looked at by itself.
    pub after: Option<Model>,
    /// What else might have been, the most probable first.
    pub rivals: Vec<Tried>,
}

/// A value of the data sheet that turned out wrong, SI.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Correction {
    /// Its path in the machine file.
    pub path: String,
    /// What it was found to be.
    pub value: f64,
    /// The lower end of its 95 % interval; none where it is not identifiable.
    pub low: Option<f64>,
    /// The upper end.
    pub high: Option<f64>,
    /// What the data sheet states.
    pub nominal: f64,
    /// The SI unit of these values; empty for a pure number.
    #[serde(default)]
    pub unit: String,
    /// Probability that it is wrong, 0 to 1.
    pub probability: f64,
}

impl Found {
    /// Its effect at its place.
    pub fn candidate(&self) -> &Candidate {
        &self.effect.candidate
    }
}

/// Index of the first item of the effect `found[which]` in a machine of `problem` that has them all.
pub fn first_item(problem: &Problem, found: &[Found], which: usize) -> usize {
    let before = found[..which].iter();
    let items = before.map(|found| found.candidate().items().len());
    effects(problem) + items.sum::<usize>()
}

/// How many effects a problem's machine has.
pub(crate) fn effects(problem: &Problem) -> usize {
    problem.tree["effects"].as_array().map_or(0, Vec::len)
}
