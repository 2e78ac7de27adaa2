//! Another effect beside wear.
//!
//! Where a joint has more play than was believed, its blows fall elsewhere in the revolution. Then neither an
//! effect that changes the blows nor the play alone reduces the residual far, and adding one after the other
//! leads nowhere. Where no candidate by itself closes most of the gap,
//! the most promising ones are fitted again in machines with more play.

use crate::candidate::Candidate;
use crate::criteria::{closes_most, earns, evidence};
use crate::error::{Error, possible};
use crate::finding::{Found, Tried, first_item, without};
use crate::fitter::Fitter;
use crate::model::Model;
use crate::moves::screen::Screened;
use crate::moves::signature::rivals;
use crate::search::refit::Rough;
use input::effects::Proposal;
use rayon::prelude::*;

/// The play that is tried, over the effect's usual one. From each to the next is about as far as a descent goes.
const TIMES: [f64; 5] = [1.2, 1.8, 2.7, 4.0, 6.0];
/// In how many joints, the most promising first.
const JOINTS: usize = 2;
/// How many candidates are fitted beside it.
const BESIDE: usize = 4;
/// What wear and another effect may hide leaves more than this.
const LEFT: f64 = 3.0;

/// A candidate and the values at which a fit starts, SI.
type Start = (Candidate, Vec<f64>);

/// Wear and another effect that together close most of the gap of `model`, each of which earns its place
/// beside the other; and the model with both. They are searched only where none of `rough`, which were
/// fitted to the runs of `few`, does as much by itself.
pub(crate) fn beside_wear(
    fitter: &Fitter,
    model: &Model,
    few: &Model,
    rough: &[Rough],
    screened: &[Screened],
) -> Result<Option<(Vec<Found>, Model)>, Error> {
    let is_hidden =
        |best: &Rough| best.model.fitted > LEFT && !closes_most([few.fitted, best.model.fitted]);
    if !rough.first().is_some_and(is_hidden) {
        return Ok(None);
    }
    let Some((pair, near)) = worn(fitter, few, rough, screened)? else {
        return Ok(None);
    };
    let mut with = model.problem.clone();
    for (candidate, values) in &pair {
        with = candidate.added(&with, values)?;
    }
    let Some(after) = possible(fitter.fit(with, &near.x))? else {
        return Ok(None);
    };
    let pair = pair.map(|(candidate, _)| candidate);
    let found = each(fitter, model, &after, pair, screened)?;
    Ok(found.map(|found| (found, after)))
}

/// The least play with which an effect beside it closes most of the gap of `few`, that effect, and the
/// model with both.
fn worn(
    fitter: &Fitter,
    few: &Model,
    rough: &[Rough],
    screened: &[Screened],
) -> Result<Option<([Start; 2], Model)>, Error> {
    let is_wear = |candidate: &&Candidate| candidate.entry.proposal == Proposal::Wear;
    let others = rough.iter().filter(|rough| !is_wear(&&rough.candidate));
    let others: Vec<&Rough> = others.take(BESIDE).collect();
    let joints = screened.iter().map(|s| &s.candidate).filter(is_wear);
    for wear in joints.take(JOINTS) {
        for times in TIMES {
            if !fitter.effort.goes_on_beside_wear() {
                return Ok(None);
            }
            let play: Vec<f64> = wear.usual().iter().map(|usual| times * usual).collect();
            let worn = wear.added(&few.problem, &play)?;
            let beside = others.par_iter().map(|other| {
                let label = other.candidate.label();
                (fitter.say)(&format!("{label} beside {}", wear.label()), few.fitted);
                // Without what is missing the calibration has gone astray.
                let with = other.candidate.added(&worn, &other.values)?;
                possible(fitter.rough(with, &[]))
            });
            let beside = beside.collect::<Result<Vec<_>, Error>>()?;
            let fitted = others.iter().zip(beside);
            let fitted = fitted.filter_map(|(other, model)| Some((other, model?)));
            let best = fitted.min_by(|(_, a), (_, b)| a.criterion().total_cmp(&b.criterion()));
            if let Some((other, model)) = best
                && closes_most([few.fitted, model.fitted])
            {
                let other = (other.candidate.clone(), other.values.clone());
                return Ok(Some(([(wear.clone(), play), other], model)));
            }
        }
    }
    Ok(None)
}

/// Two effects of `after` that `before` has not, each with what speaks for it beside the other; none
/// where one does not earn its place.
fn each(
    fitter: &Fitter,
    before: &Model,
    after: &Model,
    pair: [Candidate; 2],
    screened: &[Screened],
) -> Result<Option<Vec<Found>>, Error> {
    let others = screened.iter().filter(|s| !pair.contains(&s.candidate));
    let others: Vec<Screened> = others.cloned().collect();
    let score = |candidate: &Candidate| {
        let screened = screened.iter().find(|s| s.candidate == *candidate);
        screened.map_or(0.0, |screened| screened.score)
    };
    let mut found: Vec<Found> = Vec::new();
    for candidate in pair.clone() {
        let index = first_item(&before.problem, &found, found.len());
        found.push(Found {
            effect: Tried {
                values: candidate.values(after, index),
                evidence: evidence(before, after, score(&candidate)),
                candidate,
                likeness: None,
                model: Some(after.clone()),
            },
            gap: None,
            rivals: Vec::new(),
        });
    }
    for (i, candidate) in pair.iter().enumerate() {
        let (problem, x) = without(&before.problem, after, &found, i)?;
        let alone = possible(fitter.fit(problem, &x))?;
        let Some(alone) = alone.filter(|alone| earns(alone, after)) else {
            return Ok(None);
        };
        found[i].effect.evidence = evidence(&alone, after, score(candidate));
        let effect = &found[i].effect;
        // The same machine, this effect the last.
        let with = candidate.added(&alone.problem, &effect.values)?;
        let with = Model::at(with, &x, fitter.effort)?;
        let few = fitter.few(&alone)?;
        found[i].rivals = rivals(fitter, &few, &with, effect, &others, &[])?;
    }
    if let Some(last) = found.last_mut() {
        last.gap = Some(after.gap());
    }
    Ok(Some(found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{effort, fitter, problem_of};
    use serde_json::json;

    #[test]
    fn an_effect_that_shows_in_a_worn_joint_alone_is_found_with_the_wear() {
        let mut problem = problem_of(json!([
            {"bearing_ovality": {"joint": "small_end", "part": "journal", "amplitude": "0.05 mm",
                "direction": "1 rad"}},
            {"extra_clearance": {"joint": "small_end", "clearance": "0.17 mm"}},
        ]));
        problem.runs.truncate(1);
        let effort = effort();
        let fitter = fitter(&effort);
        let candidate = |label: &str| {
            let mut all = Candidate::all(&problem).into_iter();
            all.find(|candidate| candidate.label() == label).unwrap()
        };
        let ovality = candidate("bearing_ovality small_end journal");
        let pair = [candidate("extra_clearance small_end"), ovality.clone()];
        let screened = pair.clone().map(|candidate| Screened {
            candidate,
            score: 0.5,
            starts: Vec::new(),
        });
        let model = Model::at(problem.clone(), &[0.0], &effort).unwrap();
        let values = ovality.usual();
        let added = ovality.added(&problem, &values).unwrap();
        let mut rough = [Rough {
            candidate: ovality,
            score: 0.5,
            values,
            model: Model::at(added, &[], &effort).unwrap(),
        }];
        let beside =
            |rough: &[Rough]| beside_wear(&fitter, &model, &model, rough, &screened).unwrap();
        let (found, with) = beside(&rough).unwrap();
        assert!(with.fitted < 1e-2, "{}", with.fitted);
        for (found, (candidate, truth)) in found.iter().zip(pair.iter().zip([1.7e-4, 5e-5])) {
            let found = &found.effect;
            assert_eq!(found.candidate, *candidate);
            assert!(
                (found.values[0] / truth - 1.0).abs() < 1e-3,
                "{:?}",
                found.values
            );
            // What is left without it, where the other one is there.
            assert!(found.evidence.is_sure() && found.evidence.misfit[0] != model.fitted);
        }
        // One that does as much by itself needs no wear.
        rough[0].model.fitted = 0.1 * model.fitted;
        assert!(beside(&rough).is_none());
    }
}
