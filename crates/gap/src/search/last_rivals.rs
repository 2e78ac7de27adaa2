//! Rivals of an effect, judged again where more was found after it.
//!
//! When an effect is added, other candidates may leave as much as it does, because all of them leave
//! what is still missing. Beside what was found later they need not.

use crate::criteria::evidence;
use crate::error::{Error, possible};
use crate::finding::{Found, Tried, is_rival, without};
use crate::fitter::Fitter;
use crate::model::Model;
use calibrate::Problem;

/// The effects of `model`, each with those of its rivals that are rivals beside the other effects, too.
pub(crate) fn with_last_rivals(
    fitter: &Fitter,
    problem: &Problem,
    model: &Model,
    mut found: Vec<Found>,
) -> Result<Vec<Found>, Error> {
    for i in 0..found.len() {
        let mut rivals = Vec::new();
        for rival in std::mem::take(&mut found[i].rivals) {
            if is_rival(&rival, &found[i].effect.evidence, model.fitted) {
                rivals.push(rival);
            } else if let Some(rival) = in_place(fitter, problem, model, &found, i, &rival)? {
                rivals.push(rival);
            }
        }
        found[i].rivals = rivals;
    }
    Ok(found)
}

/// A rival of the effect `found[which]`, fitted in its place; none where it leaves too much.
fn in_place(
    fitter: &Fitter,
    problem: &Problem,
    model: &Model,
    found: &[Found],
    which: usize,
    rival: &Tried,
) -> Result<Option<Tried>, Error> {
    (fitter.say)(
        &format!("with {} instead", rival.candidate.label()),
        model.fitted,
    );
    let (without, x) = without(problem, model, found, which)?;
    let before = Model::at(without, &x, fitter.effort)?;
    // What was found later itself is no rival beside the others.
    let Ok(with) = rival.candidate.added(&before.problem, &rival.values) else {
        return Ok(None);
    };
    let Some(after) = possible(fitter.rough(with, &x))? else {
        return Ok(None);
    };
    let beside = evidence(&before, model, found[which].effect.evidence.score);
    let score = rival.evidence.score;
    let rival = Tried::fitted(rival.candidate.clone(), &before, &after, score);
    Ok(is_rival(&rival, &beside, model.fitted).then_some(rival))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidate::Candidate;
    use crate::fixture::{effort, fitter, problem};

    #[test]
    fn what_is_left_with_a_rival_counts_beside_all_that_was_found() {
        let problem = problem();
        let effort = effort();
        let fitter = fitter(&effort);
        let candidate = |name: &str| Candidate::first(&problem, name);
        let rings = candidate("ring_friction");
        let values = [150.0, 1e-9, 0.01];
        let added = rings.added(&problem, &values).unwrap();
        let model = fitter.fit(added, &[]).unwrap();
        assert!(model.fitted < 0.3, "{}", model.fitted);
        // The recordings of this problem have no noise; a third of what they claim would leave so much.
        let model = Model {
            fitted: 0.3,
            ..model
        };
        let without = Model::at(problem.clone(), &[0.0], &effort).unwrap();
        let stale = |candidate: Candidate, values: &[f64]| {
            let mut evidence = evidence(&without, &model, 0.5);
            // Something else was missing when it was tried.
            evidence.misfit = [50.0 * without.fitted, 20.0 * without.fitted];
            Tried {
                candidate,
                values: values.to_vec(),
                evidence,
                likeness: None,
                model: None,
            }
        };
        // The same rings, stuck to the piston less firmly, do as well; a force of orders 1 and 2 does not.
        let same = stale(rings.clone(), &[140.0, 1e-9, 0.011]);
        let other = stale(candidate("misalignment"), &[100.0, 0.0, 50.0, 0.0]);
        let found = Found {
            effect: Tried {
                values: values.to_vec(),
                model: Some(model.clone()),
                ..Tried::fitted(rings.clone(), &without, &model, 0.5)
            },
            gap: None,
            rivals: vec![other, same],
        };
        let judged = with_last_rivals(&fitter, &problem, &model, vec![found.clone()]);
        let rivals = judged.unwrap().remove(0).rivals;
        let [rival] = &rivals[..] else {
            panic!(
                "{:?}",
                rivals.iter().map(|r| r.leaves()).collect::<Vec<_>>()
            );
        };
        assert_eq!(rival.candidate, rings);
        assert!(rival.leaves() < 0.3, "{}", rival.leaves());
        // A rival that was found itself afterwards does not count.
        let force = candidate("misalignment");
        let added = force.added(&model.problem, &[1.0, 0.0, 1.0, 0.0]).unwrap();
        let both = Model {
            x: [&model.x[..], &[0.0; 4]].concat(),
            problem: added,
            ..model.clone()
        };
        let of = |candidate: &Candidate, rivals| {
            let mut found = found.clone();
            found.effect.candidate = candidate.clone();
            Found { rivals, ..found }
        };
        let later = stale(force.clone(), &[100.0, 0.0, 50.0, 0.0]);
        let pair = vec![of(&rings, vec![later]), of(&force, Vec::new())];
        let pair = with_last_rivals(&fitter, &problem, &both, pair).unwrap();
        assert!(pair.iter().all(|found| found.rivals.is_empty()));
    }
}
