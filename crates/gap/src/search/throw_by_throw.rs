//! Each throw of several by itself: a machine with half the parameters, and half as dear.

use crate::candidate::Candidate;
use crate::criteria::{NOISE, earns};
use crate::error::Error;
use crate::finding::{Found, added};
use crate::fitter::Fitter;
use crate::model::Model;
use crate::search::one_by_one::{MOST, while_they_earn};
use calibrate::Problem;
use calibrate::throw_alone::throws_alone;

/// The model with the effects that each throw shows by itself, where throws can be taken apart and
/// the full model is better with them. The unchanged model elsewhere.
pub(crate) fn throw_by_throw(
    fitter: &Fitter,
    model: Model,
    candidates: &dyn Fn(&Problem) -> Vec<Candidate>,
) -> Result<(Model, Vec<Found>), Error> {
    if model.fitted <= NOISE {
        return Ok((model, Vec::new()));
    }
    // What acts on the whole machine does not show in one throw alone.
    let own = |problem: &Problem| {
        let mut own = candidates(problem);
        own.retain(|candidate| candidate.throw().is_some());
        own
    };
    let mut found: Vec<Found> = Vec::new();
    let mut alone = Vec::new();
    for throw in throws_alone(&model.problem)? {
        let start: Vec<f64> = throw.parameters.iter().map(|i| model.x[*i]).collect();
        let throw_model = Model::at(throw.problem, &start, fitter.effort)?;
        alone.push((throw_model, throw.parameters));
    }
    // Where most is missing an effect is seen best, and may be all that there is.
    alone.sort_by(|(a, _), (b, _)| b.fitted.total_cmp(&a.fitted));
    let mut explained = model;
    for (throw, parameters) in alone {
        let most = MOST.saturating_sub(found.len());
        if explained.fitted <= NOISE || most == 0 {
            break;
        }
        let of_throw = while_they_earn(fitter, throw, NOISE, most, own)?;
        let (throw, mut of_throw) = (of_throw.model, of_throw.found);
        if of_throw.is_empty() {
            continue;
        }
        let with = added(
            &explained.problem,
            of_throw.iter().map(|found| &found.effect),
        )?;
        let mut x = explained.x.clone();
        for (i, own) in parameters.iter().zip(&throw.x) {
            x[*i] = *own;
        }
        let after = fitter.fit(with, &x)?;
        if earns(&explained, &after) {
            // Each by itself was judged in this throw alone.
            let last = of_throw.len() - 1;
            for (i, found) in of_throw.iter_mut().enumerate() {
                found.gap = (i == last).then(|| after.gap());
            }
            explained = after;
            found.extend(of_throw);
        }
    }
    Ok((explained, found))
}
