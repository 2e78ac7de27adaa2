//! The workflow: pressures first, which hardly depend on the joints, then everything.

use crate::amendment::Amendment;
use crate::criteria::{EXPLAINED, Verdict, explains, verdict};
use crate::error::{Error, possible};
use crate::finding::{Correction, Found, Tried};
use crate::fitter::effort::Effort;
use crate::fitter::{Fitter, Watch};
use crate::force::empirical_force;
use crate::force::missing_force::MissingForce;
use crate::gas::{has_joints, pressures};
use crate::mains_hum::Hum;
use crate::measuring_chain::{crank_angle_offset, mains_hum};
use crate::model::Model;
use crate::recorded::is_of_pressures;
use crate::results::next_recording::next_recording;
use crate::search::hypothesis::{Amended, Hypothesis, View, added};
use crate::search::judgement::{Forms, Judgement, judged};
use crate::steps::{StepModel, steps};
use calibrate::Problem;
use calibrate::fit::Estimate;
use nalgebra::DMatrix;

/// What the workflow did and found.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// The calibrated model without any added effect.
    pub baseline: Model,
    /// The model with the effects that were found.
    pub explained: Model,
    /// The effects, in the order in which they were added.
    pub found: Vec<Found>,
    /// Values of the data sheet that turned out wrong.
    pub corrections: Vec<Correction>,
    /// What is wrong with the measuring: it was taken off or fitted to begin with.
    pub chain: Vec<Found>,
    /// What this comes to.
    pub verdict: Verdict,
    /// What was fitted to all runs and is not believed.
    pub refused: Vec<Tried>,
    /// The machine as it was given.
    pub nominal: Model,
    /// The gap as it shrank, the machine as it was given first.
    pub steps: Vec<StepModel>,
    /// What to measure to distinguish effects from their rivals, in a sentence.
    pub next_recording: Option<String>,
    /// What the parameters of the explained model are known to.
    pub estimates: Vec<Estimate>,
    /// The force that is missing where the catalogue explains too little; empty elsewhere.
    pub missing_force: Vec<MissingForce>,
    /// Correlation between each pair of them.
    pub correlations: DMatrix<f64>,
}

/// What is being done, for a progress bar.
#[derive(Clone, Debug)]
pub struct Stage {
    /// In words.
    pub words: String,
    /// The misfit so far.
    pub misfit: f64,
}

/// Explains the gap between the problem's machine and its recordings, which `hum` has been taken off. `start` are the
/// coordinates from which the calibration begins.
///
/// # Errors
/// A machine that cannot be simulated; [`Error::Stopped`].
pub fn explain(
    problem: &Problem,
    start: Option<&[f64]>,
    hum: &[Hum],
    effort: &Effort,
    report: &(dyn Fn(&Stage) + Sync),
    watch: Watch,
) -> Result<Explanation, Error> {
    let say = |words: &str, misfit: f64| {
        report(&Stage {
            words: words.to_owned(),
            misfit,
        });
    };
    let fitter = &Fitter {
        effort,
        watch,
        say: &say,
    };
    let nominal = vec![0.0; problem.parameters.len()];
    let Whole {
        mut baseline,
        mut model,
        mut found,
        refused,
        probabilities,
    } = whole(fitter, problem, start.unwrap_or(&nominal))?;
    let mut missing_force = Vec::new();
    if found.is_empty()
        && verdict(&baseline, &model, 0) == Verdict::Unexplained
        && !is_of_pressures(problem)
        && !effort.chaotic
        && let Some(force) = empirical_force(fitter, &model)?
    {
        missing_force = force.missing;
        // A law that explains everything is one; what leaves more may be the form of something else.
        if let Some((tried, after)) = force.law
            && after.fitted <= EXPLAINED
            && after.held_out.is_some_and(|held| held <= EXPLAINED)
        {
            found.push(Found {
                after: Some(after.clone()),
                effect: tried,
                rivals: Vec::new(),
            });
            model = after;
        }
    }
    say("finding bounds", model.fitted);
    let (mut estimates, correlations) = match by_energies(&found) {
        true => without_intervals(&model),
        false => {
            let fit = fitter.bounds(&model)?;
            (fit.estimates, fit.correlations)
        }
    };
    if let Some(last) = found.last_mut()
        && let Some(nearer) = nearer(&model, &estimates, effort)?
    {
        last.after = Some(nearer.clone());
        model = nearer;
    }
    as_in_model(&mut estimates, &model.x);
    let corrections = corrections(&estimates, &probabilities);
    let mut chain: Vec<Found> = hum.iter().filter_map(|h| mains_hum(h, &model)).collect();
    let calibrated = baseline.clone();
    if let Some(offset) = crank_angle_offset(fitter, &estimates, &model, found.len())? {
        chain.push(offset);
        baseline = set_right(fitter, problem)?;
    }
    let named = found.len() + chain.len() + corrections.len();
    let verdict = verdict(&baseline, &model, named);
    let nominal = Model::at(problem.clone(), &[], 0.0, effort)?;
    Ok(Explanation {
        steps: steps(&nominal, &baseline, &chain, &calibrated, &found, &model),
        next_recording: next_recording(fitter, &found)?,
        nominal,
        corrections,
        chain,
        estimates,
        correlations,
        baseline,
        explained: model,
        found,
        verdict,
        refused,
        missing_force,
    })
}

/// Whether energies decided on what was found: no fit follows the ringing.
pub(crate) fn by_energies(found: &[Found]) -> bool {
    found
        .iter()
        .any(|one| one.effect.evidence.energies.is_some())
}

/// The values of a model's parameters, and their correlations, where no fit says how well they are known.
fn without_intervals(model: &Model) -> (Vec<Estimate>, DMatrix<f64>) {
    let estimates = model.problem.parameters.iter().zip(&model.x);
    let estimates = estimates.map(|(parameter, x)| Estimate {
        value: parameter.value(*x),
        parameter: parameter.clone(),
        interval: None,
    });
    let count = model.x.len();
    (estimates.collect(), DMatrix::identity(count, count))
}

/// The model where the fit that gives the intervals has ended, if that leaves less: it goes on for longer.
fn nearer(model: &Model, estimates: &[Estimate], effort: &Effort) -> Result<Option<Model>, Error> {
    let ends = estimates
        .iter()
        .map(|one| one.parameter.coordinate(one.value));
    let x: Vec<f64> = ends.collect();
    let there = possible(Model::at(model.problem.clone(), &x, model.timing, effort))?;
    let leaves_less =
        |there: &Model| there.deviance < model.deviance && there.fitted < model.fitted;
    Ok(there.filter(leaves_less))
}

/// The values with which the model was found, coordinates `x`, as the machine file has them: the fit that gives the intervals may end
/// beside them, and estimates the others beside the start value of one that is not identifiable. The intervals include those about
/// both.
fn as_in_model(estimates: &mut [Estimate], x: &[f64]) {
    for (estimate, x) in estimates.iter_mut().zip(x) {
        let parameter = &estimate.parameter;
        let moved = x - parameter.coordinate(estimate.value);
        let [lowest, highest] = parameter.box_bounds();
        let end = |end: f64, moved: f64| {
            let x = parameter.coordinate(end) + moved;
            parameter.value(x.clamp(lowest, highest))
        };
        if let Some([low, high]) = estimate.interval {
            estimate.interval = Some([end(low, moved.min(0.0)), end(high, moved.max(0.0))]);
        }
        estimate.value = parameter.value(*x);
    }
}

/// The machine without effects, calibrated as if the zero of the crank angle were at top dead centre.
fn set_right(fitter: &Fitter, problem: &Problem) -> Result<Model, Error> {
    let mut problem = problem.clone();
    problem.parameters.retain(|p| !p.is_crank_angle_offset());
    let start = vec![0.0; problem.parameters.len()];
    let found = fitter.explored(&[(problem, start)])?;
    found.map(|(model, _)| model).ok_or(Error::Nothing)
}

/// What pressures and everything else come to together.
struct Whole {
    baseline: Model,
    model: Model,
    found: Vec<Found>,
    refused: Vec<Tried>,
    /// Corrections with their probabilities.
    probabilities: Vec<(String, f64)>,
}

fn whole(fitter: &Fitter, problem: &Problem, start: &[f64]) -> Result<Whole, Error> {
    let all = Amendment::all(problem)?;
    let mut probabilities = Vec::new();
    let mut known: Vec<Amended> = Vec::new();
    let mut found: Vec<Found> = Vec::new();
    let mut others = all.clone();
    if let Some(pressures) = pressures(problem)? {
        (fitter.say)("looking at the pressures", f64::NAN);
        let (gas, forms): (Vec<Amendment>, _) = match has_joints(problem) {
            true => {
                let of_gas = all.iter().filter(|one| one.is_of_gas());
                (of_gas.cloned().collect(), Forms::Free)
            }
            false => (all.clone(), Forms::UsualWhereTheySuffice),
        };
        let own: Vec<f64> = own_start(problem, start, &pressures);
        let judged = judged(fitter, &pressures, &own, &gas, forms)?;
        if !has_joints(problem) {
            return with_joints(fitter, problem, judged, &pressures);
        }
        found = judged.named_effects(&pressures);
        probabilities = corrected(&judged);
        let values = judged.believed.values(&pressures);
        let set = judged.believed.set.iter().zip(values);
        known = set
            .map(|(one, values)| Amended {
                amendment: one.amendment.clone(),
                values,
            })
            .collect();
        let shown = |one: &Amendment| {
            one.effect()
                .is_some_and(|effect| effect.is_shown_by_pressures(problem))
        };
        // What pressures leave may come from the joints, and hide what is their own.
        let explained = explains(&judged.believed.model);
        let closed = |one: &Amendment| judged.believed.has(one) || explained && shown(one);
        others.retain(|one| !closed(one));
    }
    known = at_their_ends(fitter, problem, known)?;
    let with_gas = added(problem, &known)?;
    let mut start = start.to_vec();
    start.resize(with_gas.parameters.len(), 0.0);
    let judged = judged(
        fitter,
        &with_gas,
        &start,
        &others,
        Forms::UsualWhereTheySuffice,
    )?;
    let baseline = match known.is_empty() {
        true => judged.nothing.model.clone(),
        false => {
            (fitter.say)("calibrating without an effect", judged.nothing.model.fitted);
            let own = start[..problem.parameters.len()].to_vec();
            let without = fitter.explored(&[(problem.clone(), own)])?;
            without.map(|(model, _)| model).ok_or(Error::Nothing)?
        }
    };
    if let Some(last) = found.last_mut() {
        last.after = Some(judged.nothing.model.clone());
    }
    let (known, model) = in_usual_forms(fitter, problem, known, &judged.believed)?;
    for (found, known) in found
        .iter_mut()
        .zip(known.iter().filter_map(|one| one.amendment.effect()))
    {
        found.effect.candidate = known.clone();
    }
    found.extend(judged.named_effects(&with_gas));
    if let Some(last) = found.last_mut() {
        last.after = Some(model.clone());
    }
    probabilities.extend(corrected(&judged));
    Ok(Whole {
        baseline,
        refused: judged.refused(&with_gas),
        probabilities,
        model,
        found,
    })
}

/// What is known of the gas, in the usual forms of its laws where all recordings together do not need others, and the model
/// with that and what is believed beside it.
fn in_usual_forms(
    fitter: &Fitter,
    problem: &Problem,
    known: Vec<Amended>,
    believed: &Hypothesis,
) -> Result<(Vec<Amended>, Model), Error> {
    let count = known.len();
    let set = [known, believed.set.clone()].concat();
    let all = Hypothesis::new(set, believed.model.clone(), problem.parameters.len());
    let mut all = match believed.view {
        View::Lines => all.of_usual_form(count, fitter, problem)?,
        View::Energies => all,
    };
    all.set.truncate(count);
    Ok((all.set, all.model))
}

/// The effects of the gas. Each acts at the one end of its cylinder whose pressure was recorded, where everything that
/// was recorded is likelier so.
fn at_their_ends(
    fitter: &Fitter,
    problem: &Problem,
    mut known: Vec<Amended>,
) -> Result<Vec<Amended>, Error> {
    let few = fitter.few(problem)?.different;
    let deviance = |known: &[Amended]| -> Result<f64, Error> {
        let with = added(&few, known)?;
        let start = vec![0.0; with.parameters.len()];
        let rough = fitter.roughly(&[(with, start)])?;
        Ok(rough.map_or(f64::INFINITY, |rough| rough.deviance))
    };
    for i in 0..known.len() {
        let alone = known[i]
            .amendment
            .effect()
            .and_then(|effect| effect.at_recorded_end(problem));
        let Some(alone) = alone.map(Amendment::Effect) else {
            continue;
        };
        (fitter.say)("looking at one end of the cylinder", f64::NAN);
        let before = deviance(&known)?;
        let both = std::mem::replace(&mut known[i].amendment, alone);
        if deviance(&known)? >= before {
            known[i].amendment = both;
        }
    }
    Ok(known)
}

/// What the pressures alone come to, with the joints and the recordings of `problem`.
fn with_joints(
    fitter: &Fitter,
    problem: &Problem,
    judged: Judgement,
    pressures: &Problem,
) -> Result<Whole, Error> {
    let full = |hypothesis: &Hypothesis| {
        let model = &hypothesis.model;
        let mut full = problem.clone();
        if let Some(effects) = model.problem.tree.get("effects") {
            full.tree["effects"] = effects.clone();
        }
        full.parameters.clone_from(&model.problem.parameters);
        Model::at(full, &model.x, model.timing, fitter.effort)
    };
    Ok(Whole {
        baseline: full(&judged.nothing)?,
        model: full(&judged.believed)?,
        found: judged.named_effects(pressures),
        refused: judged.refused(pressures),
        probabilities: corrected(&judged),
    })
}

/// The corrections of a judgement, with their probabilities.
fn corrected(judged: &Judgement) -> Vec<(String, f64)> {
    let set = judged.believed.set.iter().zip(&judged.probabilities);
    let corrections = set.filter(|(one, _)| one.amendment.effect().is_none());
    corrections
        .map(|(one, probability)| (one.amendment.label(), *probability))
        .collect()
}

/// The coordinates of those parameters of `problem` that `part` has.
fn own_start(problem: &Problem, start: &[f64], part: &Problem) -> Vec<f64> {
    let of = |path: &str| problem.parameters.iter().position(|p| p.path == path);
    let own = part
        .parameters
        .iter()
        .map(|p| of(&p.path).map_or(0.0, |i| start[i]));
    own.collect()
}

fn corrections(estimates: &[Estimate], probabilities: &[(String, f64)]) -> Vec<Correction> {
    let of = |(path, probability): &(String, f64)| {
        let estimate = estimates.iter().find(|e| e.parameter.path == *path)?;
        Some(Correction {
            path: path.clone(),
            value: estimate.value,
            low: estimate.interval.map(|[low, _]| low),
            high: estimate.interval.map(|[_, high]| high),
            nominal: estimate.parameter.nominal,
            unit: estimate
                .parameter
                .dimension
                .map_or_else(String::new, |dimension| dimension.to_string()),
            probability: *probability,
        })
    };
    probabilities.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{effort, problem, problem_of};
    use serde_json::json;

    #[test]
    fn a_model_goes_to_where_its_last_fit_leaves_less_and_nowhere_else() {
        let problem = problem_of(json!([]));
        let parameter = problem.parameters[0].clone();
        let effort = effort();
        let model = Model::at(problem, &[0.02], 0.0, &effort).unwrap();
        let ended = |x: f64| {
            let estimate = Estimate {
                value: parameter.value(x),
                parameter: parameter.clone(),
                interval: None,
            };
            nearer(&model, &[estimate], &effort).unwrap()
        };
        let there = ended(0.0).unwrap();
        assert!(there.x[0].abs() < 1e-12 && there.fitted < model.fitted);
        assert!(ended(0.05).is_none());
    }

    #[test]
    fn beside_a_value_that_is_not_identifiable_all_are_those_of_the_machine_file() {
        let problem = problem();
        let estimate = |parameter: &calibrate::Parameter, known: bool| Estimate {
            parameter: parameter.clone(),
            value: parameter.value(0.1),
            interval: known.then(|| [parameter.value(0.05), parameter.value(0.15)]),
        };
        let parameter = &problem.parameters[0];
        let mut open = [estimate(parameter, true), estimate(parameter, false)];
        as_in_model(&mut open, &[0.3, 0.2]);
        assert_eq!(open[0].value, parameter.value(0.3));
        // About 0.1, where the fit has ended, and as far about 0.3.
        let interval = open[0].interval.unwrap();
        for (end, expected) in interval.into_iter().zip([0.05, 0.35]) {
            assert!((parameter.coordinate(end) - expected).abs() < 1e-9);
        }
        assert_eq!(
            (open[1].value, open[1].interval),
            (parameter.value(0.2), None)
        );
    }
}
