//! The gas by itself: pressures hardly depend on the joints.

use crate::candidate::Candidate;
use crate::criteria::{GAS_NOISE, NOISE};
use crate::effort::Effort;
use crate::error::{Error, possible};
use crate::finding::{Explained, Found, added, with_only};
use crate::fitter::Fitter;
use crate::model::Model;
use crate::recorded::{is_of_pressures, is_pressure};
use crate::search::one_by_one::{MOST, while_they_earn};
use calibrate::Problem;
use calibrate::likelihood::Likelihood;
use serde_json::Value;

/// The same problem with the pressures alone, in a machine of ideal joints, which is simulated much
/// faster. None without recorded pressures. The effect of clear joints on the pressures is subtracted from the
/// recorded ones, as the nominal machine has it.
///
/// # Errors
/// A machine that cannot be simulated.
fn pressures(problem: &Problem) -> Result<Option<Problem>, Error> {
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

/// What the pressures alone show.
pub(crate) struct OfGas {
    /// The gas without an effect.
    pub before: Model,
    /// With those that were found.
    pub explained: Explained,
}

impl OfGas {
    /// Whether only pressures of `problem` were recorded and only the gas is fitted: nothing else is to be found then.
    pub(crate) fn is_all(&self, problem: &Problem) -> bool {
        is_of_pressures(problem) && self.before.problem.parameters == problem.parameters
    }

    /// Whether the pressures have shown what they can. What they leave between the noise and what shows an
    /// effect by itself may be the joints or a small effect: the full model has to decide.
    pub(crate) fn is_decided(&self) -> bool {
        !(NOISE..GAS_NOISE).contains(&self.explained.model.fitted)
    }

    /// Its models with the joints and the recordings of `problem`.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub(crate) fn with_joints(
        self,
        problem: &Problem,
        effort: &Effort,
    ) -> Result<(Model, Explained), Error> {
        let with_joints = |model: Model| {
            let mut full = problem.clone();
            if let Some(effects) = model.problem.tree.get("effects") {
                full.tree["effects"] = effects.clone();
            }
            full.parameters = model.problem.parameters;
            Model::at(full, &model.x, effort)
        };
        let before = with_joints(self.before)?;
        let explained = Explained {
            model: with_joints(self.explained.model)?,
            ..self.explained
        };
        Ok((before, explained))
    }
}

/// What the pressures show by themselves, which hardly depend on the joints; none where none was recorded.
///
/// # Errors
/// A machine that cannot be simulated; [`Error::Stopped`].
pub(crate) fn of_gas(fitter: &Fitter, problem: &Problem) -> Result<Option<OfGas>, Error> {
    let Some(pressures) = pressures(problem)? else {
        return Ok(None);
    };
    (fitter.say)("looking at the pressures", f64::NAN);
    let before = fitter.fit(pressures, &[])?;
    let candidates = |problem: &Problem| {
        let mut all = Candidate::all(problem);
        all.retain(Candidate::is_of_gas);
        all
    };
    let explained = while_they_earn(fitter, before.clone(), GAS_NOISE, MOST, candidates)?;
    Ok(Some(OfGas { before, explained }))
}

/// The effects of the gas. Each acts at the one end of its cylinder whose pressure was recorded, where
/// the full model has a smaller residual with that.
pub(crate) fn at_their_ends(
    fitter: &Fitter,
    problem: &Problem,
    mut found: Vec<Found>,
) -> Result<Vec<Found>, Error> {
    let fitted = |found: &[Found]| -> Result<f64, Error> {
        let with = added(problem, found.iter().map(|found| &found.effect))?;
        let model = possible(fitter.rough(with, &[]))?;
        Ok(model.map_or(f64::INFINITY, |model| model.fitted))
    };
    let mut least = None;
    for i in 0..found.len() {
        let Some(alone) = found[i].candidate().at_recorded_end(problem) else {
            continue;
        };
        (fitter.say)("looking at one end of the cylinder", f64::NAN);
        let before = match least {
            Some(least) => least,
            None => fitted(&found)?,
        };
        let both = std::mem::replace(&mut found[i].effect.candidate, alone);
        let after = fitted(&found)?;
        if after >= before {
            found[i].effect.candidate = both;
        }
        least = Some(before.min(after));
    }
    Ok(found)
}

/// What the whole is left with after each effect of the gas, the last of which leaves `model`.
pub(crate) fn tell_gas(
    fitter: &Fitter,
    problem: &Problem,
    found: &mut [Found],
    model: &Model,
) -> Result<(), Error> {
    let last = found.len().saturating_sub(1);
    for i in 0..found.len() {
        found[i].gap = if i == last {
            Some(model.gap())
        } else if fitter.effort.goes_on() {
            (fitter.say)("calibrating with a part of the effects", model.fitted);
            Some(with_only(fitter, problem, model, &found[..=i])?.gap())
        } else {
            None
        };
    }
    Ok(())
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
