//! The gap as it shrank: a waterfall from the machine as it was given to the explained one.

use crate::finding::Found;
use crate::model::{Gap, Model};
use serde::{Deserialize, Serialize};

/// What a machine is called that was given, and one that was calibrated and has no effect.
const NOMINAL: &str = "nominal";
const CALIBRATED: &str = "calibrated";

/// A model on the way, as `gap.json` has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// What was done last: the effects that it has and the one before has not.
    pub label: String,
    /// What it leaves.
    #[serde(flatten)]
    pub gap: Gap,
}

/// A model on the way.
#[derive(Clone, Debug)]
pub struct StepModel {
    /// See [`Step::label`].
    pub label: String,
    /// The machine there.
    pub model: Model,
}

impl StepModel {
    /// What `gap.json` says of it.
    pub(crate) fn step(&self) -> Step {
        Step {
            label: self.label.clone(),
            gap: self.model.gap(),
        }
    }
}

/// The steps to `explained`: the nominal machine, the calibrated one, the corrected measuring chain
/// (with which the machine is `set_right`), and one for each effect. Effects after which the full model was not
/// fitted share a step with the next.
pub(crate) fn steps(
    nominal: &Model,
    baseline: &Model,
    chain: &[Found],
    set_right: &Model,
    found: &[Found],
    explained: &Model,
) -> Vec<StepModel> {
    let step = |label: &str, model: &Model| StepModel {
        label: label.to_owned(),
        model: model.clone(),
    };
    let mut steps = vec![step(NOMINAL, nominal), step(CALIBRATED, baseline)];
    // A hum is taken off the recordings beforehand, and leaves no other gap.
    let fitted = chain
        .iter()
        .find(|c| c.effect.evidence.misfit[0] != c.effect.evidence.misfit[1]);
    steps.extend(fitted.map(|c| step(&c.candidate().label(), set_right)));
    let mut waiting: Vec<String> = Vec::new();
    for (i, found_one) in found.iter().enumerate() {
        waiting.push(found_one.candidate().label());
        let model = match i + 1 == found.len() {
            true => Some(explained),
            false => found_one.after.as_ref(),
        };
        if let Some(model) = model {
            steps.push(step(&waiting.join(" and "), model));
            waiting.clear();
        }
    }
    steps
}
