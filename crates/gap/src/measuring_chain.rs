//! Errors of the measuring chain, not of the machine: reported as effects like any other.

use crate::amendment::candidate::Candidate;
use crate::criteria::{Evidence, NAMED, evidence, left, probability};
use crate::error::Error;
use crate::finding::{Found, Tried};
use crate::fitter::Fitter;
use crate::mains_hum::Hum;
use crate::model::Model;
use calibrate::Parameter;
use calibrate::fit::Estimate;
use input::effects::{Entry, Proposal, proposed};

/// An encoder is set to a dead centre within this, rad (a tenth of a degree): less is no finding.
const SET: f64 = 1.7e-3;
/// An offset that counts is so many times the half width of its 95 % interval.
const CLEAR: f64 = 2.0;

/// The zero of the crank angle, where it is not at top dead centre: where the model `after`, which has `others` effects
/// beside it, is left with so much more without it that it is more probable than not.
pub(crate) fn crank_angle_offset(
    fitter: &Fitter,
    estimates: &[Estimate],
    after: &Model,
    others: usize,
) -> Result<Option<Found>, Error> {
    let is_zero = |p: &Parameter| p.is_crank_angle_offset() && p.run.is_none();
    let index = after.problem.parameters.iter().position(is_zero);
    let estimate = estimates.iter().find(|e| is_zero(&e.parameter));
    let (Some(index), Some(estimate)) = (index, estimate) else {
        return Ok(None);
    };
    let clear = estimate
        .interval
        .is_some_and(|[low, high]| estimate.value.abs() > CLEAR * 0.5 * (high - low));
    let Some(entry) = proposed(Proposal::CrankAngleZero).filter(|_| clear) else {
        return Ok(None);
    };
    if estimate.value.abs() < SET {
        return Ok(None);
    }
    let (mut problem, mut x) = (after.problem.clone(), after.x.clone());
    problem.parameters.remove(index);
    x.remove(index);
    let Some(without) = fitter.settled(&(problem, x))? else {
        return Ok(None);
    };
    let probability = probability(left(&without.gap(), &after.gap()), others, 1);
    let evidence = evidence(&without, after);
    let found = finding(
        entry,
        Vec::new(),
        vec![estimate.value],
        evidence,
        probability,
    );
    Ok(Some(found).filter(|_| probability > NAMED))
}

/// A hum as an effect.
pub(crate) fn mains_hum(hum: &Hum, model: &Model) -> Option<Found> {
    let entry = proposed(Proposal::Hum)?;
    let of = |key: &str, start: f64| match key {
        "amplitude" => hum.amplitude,
        "frequency" => hum.frequency,
        _ => start,
    };
    let values = entry.parameters.iter().map(|p| of(p.key, p.start));
    let throw = hum.channel.split_once('.').map(|(throw, _)| throw);
    let place = throw.map(|throw| ("throw", throw.to_owned())).into_iter();
    let evidence = Evidence {
        log_odds: hum.over_noise.ln(),
        misfit: [model.fitted; 2],
        heldout_misfit: model.held_out.map(|held_out| [held_out; 2]),
        timing: model.timing,
        energies: None,
    };
    let (place, values) = (place.collect(), values.collect());
    Some(finding(entry, place, values, evidence, 1.0))
}

fn finding(
    entry: &'static Entry,
    place: Vec<(&'static str, String)>,
    values: Vec<f64>,
    evidence: Evidence,
    probability: f64,
) -> Found {
    let candidate = Candidate {
        entry,
        place,
        fixed: Vec::new(),
        each: Vec::new(),
        shared: false,
        formed: false,
    };
    Found {
        effect: Tried {
            candidate,
            values,
            evidence,
            probability,
            model: None,
        },
        after: None,
        rivals: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{effort, fitter, problem, problem_of};
    use calibrate::Problem;
    use serde_json::json;

    /// The probability of an offset in a problem in which it is free, and was found to be 1° with little doubt.
    fn named(mut problem: Problem, effort: &crate::fitter::effort::Effort) -> Option<f64> {
        let zero = Parameter::named(&problem.tree, &[], "crank_angle_offset", None).unwrap();
        problem.parameters.push(zero);
        let offset = problem.parameters[1].clone();
        let value = 1.0_f64.to_radians();
        let x = [0.0, offset.coordinate(value)];
        let model = Model::at(problem, &x, 0.0, effort).unwrap();
        let estimate = Estimate {
            parameter: offset,
            value,
            interval: Some([0.99 * value, 1.01 * value]),
        };
        let found = crank_angle_offset(&fitter(effort), &[estimate], &model, 0).unwrap();
        found.map(|found| found.effect.probability)
    }

    #[test]
    fn a_zero_is_named_where_the_model_is_left_with_much_without_it() {
        let shifted = problem_of(json!([{"crank_angle_offset": {"offset": "1 deg"}}]));
        assert!(named(shifted, &effort()).unwrap() > 0.9);
        // Friction is hidden here, and the offset explains none of it.
        assert_eq!(named(problem(), &effort()), None);
    }
}
