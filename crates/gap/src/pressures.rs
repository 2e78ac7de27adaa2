//! The gas by itself: pressures hardly depend on the joints.

use crate::decision::{GAS_NOISE, NOISE};
use crate::error::Error;
use crate::explain::{Found, Tried};
use crate::model::{Effort, Model};
use calibrate::Problem;
use calibrate::likelihood::Likelihood;
use calibrate::observation::Observed;
use serde_json::Value;

/// The same problem with the pressures alone, in a machine of ideal joints, which is simulated much
/// faster; none where there are none. What clear joints do to the pressures is taken off the recorded
/// ones, as the nominal machine has it.
///
/// # Errors
/// A machine that cannot be simulated.
pub(crate) fn pressures(problem: &Problem) -> Result<Option<Problem>, Error> {
    let mut clear = problem.clone();
    clear
        .parameters
        .retain(|p| p.is_crank_angle_offset() || p.path.contains("cylinder."));
    for run in &mut clear.runs {
        run.channels.retain(is_pressure);
    }
    clear.runs.retain(|run| !run.channels.is_empty());
    if clear.runs.is_empty() {
        return Ok(None);
    }
    let mut ideal = clear.clone();
    idealise(&mut ideal.tree);
    let settings = ideal.runs.iter_mut().flat_map(|run| &mut run.settings);
    for (_, value) in settings.filter(|(path, _)| path.ends_with(".clearance")) {
        *value = "ideal".into();
    }
    let nominal = vec![0.0; clear.parameters.len()];
    let [with, without] = [&clear, &ideal].map(|p| Likelihood::new(p).predictions(&nominal));
    for (run, (with, without)) in ideal.runs.iter_mut().zip(with?.iter().zip(&without?)) {
        let lines = with.lines.iter().zip(&without.lines);
        for (channel, (with, without)) in run.channels.iter_mut().zip(lines) {
            let both = with.amplitude.iter().zip(&without.amplitude);
            for (recorded, (with, without)) in channel.lines.amplitude.iter_mut().zip(both) {
                *recorded -= with - without;
            }
        }
    }
    Ok(Some(ideal))
}

/// What the pressures by themselves tell.
pub(crate) struct OfGas {
    /// The gas without an effect.
    pub before: Model,
    /// With those that were found.
    pub after: Model,
    /// The effects.
    pub found: Vec<Found>,
    /// What was refused at last.
    pub refused: Vec<Tried>,
}

impl OfGas {
    /// The two models with the machine of `problem`, whose joints may be clear, where pressures are
    /// all that was recorded of it and the gas all that is fitted: nothing else is to be found.
    pub(crate) fn is_all(&self, problem: &Problem) -> bool {
        is_of_pressures(problem) && self.before.problem.parameters == problem.parameters
    }

    /// Whether the pressures have told what they can. What they leave between the noise and what shows an
    /// effect by itself may be the joints or a small effect: the whole has to tell.
    pub(crate) fn is_told(&self) -> bool {
        !(NOISE..GAS_NOISE).contains(&self.after.fitted)
    }

    /// A model of the gas with the joints and the recordings of `problem`.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub(crate) fn with_joints(
        model: Model,
        problem: &Problem,
        effort: &Effort,
    ) -> Result<Model, Error> {
        let mut whole = problem.clone();
        if let Some(effects) = model.problem.tree.get("effects") {
            whole.tree["effects"] = effects.clone();
        }
        whole.parameters = model.problem.parameters;
        Model::at(whole, model.x, effort)
    }
}

/// Whether a channel is a cylinder's pressure.
pub(crate) fn is_pressure(channel: &Observed) -> bool {
    channel.column.contains("cylinder_pressure")
}

/// Whether a cylinder's pressure was recorded.
pub(crate) fn shows_pressure(problem: &Problem) -> bool {
    let mut channels = problem.runs.iter().flat_map(|run| &run.channels);
    channels.any(is_pressure)
}

/// Whether nothing else was.
pub(crate) fn is_of_pressures(problem: &Problem) -> bool {
    let mut channels = problem.runs.iter().flat_map(|run| &run.channels);
    channels.all(is_pressure)
}

/// Makes every joint of a machine file ideal.
fn idealise(tree: &mut Value) {
    match tree {
        Value::Object(section) => {
            for (key, value) in section {
                if key == "joints" {
                    for joint in value.as_object_mut().into_iter().flatten() {
                        if let Some(clearance) = joint.1.get_mut("clearance") {
                            *clearance = "ideal".into();
                        }
                    }
                } else {
                    idealise(value);
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(idealise),
        _ => {}
    }
}
