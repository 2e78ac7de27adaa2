//! Effects one after another, as long as each earns its place.

use crate::candidate::Candidate;
use crate::criteria::earns;
use crate::error::{Error, possible};
use crate::finding::{Explained, Found, Tried, without};
use crate::fitter::Fitter;
use crate::model::Model;
use crate::moves::screen::screen;
use crate::moves::signature::rivals;
use crate::search::beside_wear::beside_wear;
use crate::search::look_alike::look_alike;
use crate::search::refit::{further, refit, roughly};
use crate::search::replication::shows_in_each;
use calibrate::Problem;

/// Most effects.
pub(crate) const MOST: usize = 3;

/// The model with one candidate after another until it is at `noise` or none earns its place;
/// and what was refused at last.
///
/// # Errors
/// A machine that cannot be simulated; [`Error::Stopped`].
pub(crate) fn while_they_earn(
    fitter: &Fitter,
    mut model: Model,
    noise: f64,
    most: usize,
    candidates: impl Fn(&Problem) -> Vec<Candidate>,
) -> Result<Explained, Error> {
    let mut found = Vec::new();
    let mut refused = Vec::new();
    while model.fitted > noise && found.len() < most {
        let effort = &fitter.effort.having(found.len());
        if !effort.goes_on() {
            break;
        }
        let fitter = &fitter.having(effort);
        (fitter.say)("screening", model.fitted);
        let few = fitter.few(&model)?;
        let candidates = candidates(&model.problem);
        let screened = screen(fitter, &few, candidates)?;
        let rough = roughly(fitter, &few, screened.clone())?;
        let goes_on = effort.goes_on();
        if found.len() + 1 < most
            && let Some((pair, both)) = beside_wear(fitter, &model, &few, &rough, &screened)?
        {
            found.extend(pair);
            model = both;
            continue;
        }
        let rough = match goes_on {
            true => further(fitter, &few, rough)?,
            false => rough,
        };
        let mut tried = refit(fitter, &model, &few, rough)?;
        if tried.is_empty() {
            break;
        }
        // Those fitted to all runs come first.
        let shows = |(tried, after): &(Tried, Model)| {
            let whole = after.problem.runs.len() == model.problem.runs.len();
            whole && shows_in_each(&tried.candidate, &model, after)
        };
        let (mut best, mut after) = tried.remove(tried.iter().position(shows).unwrap_or(0));
        let mut others: Vec<Tried> = tried.into_iter().map(|(tried, _)| tried).collect();
        if !(earns(&model, &after) && shows_in_each(&best.candidate, &model, &after)) {
            refused.push(best);
            refused.append(&mut others);
            break;
        }
        let rivals = |best: &Tried, after: &Model, others: &[Tried]| {
            rivals(fitter, &few, after, best, &screened, others)
        };
        let mut like = rivals(&best, &after, &others)?;
        let models = [&model, &few, &after];
        if let Some((better, nearer)) = look_alike(fitter, models, &others, &like)? {
            others.push(std::mem::replace(&mut best, better));
            after = nearer;
            like = rivals(&best, &after, &others)?;
        }
        found.push(Found::new(best, &after, like));
        model = after;
    }
    Ok(Explained {
        model,
        found,
        refused,
    })
}

/// The model without those of its effects that no longer earn their place beside the others.
///
/// # Errors
/// A machine that cannot be simulated; [`Error::Stopped`].
pub(crate) fn pruned(
    fitter: &Fitter,
    problem: &Problem,
    explained: Explained,
) -> Result<Explained, Error> {
    let Explained {
        mut model,
        mut found,
        refused,
    } = explained;
    let mut i = 0;
    while found.len() > 1 && i < found.len() {
        let label = found[i].candidate().label();
        (fitter.say)(&format!("without {label}"), model.fitted);
        let (without, x) = without(problem, &model, &found, i)?;
        let without = possible(fitter.fit(without, &x))?;
        match without.filter(|without| !earns(without, &model)) {
            None => i += 1,
            Some(without) => {
                found.remove(i);
                // What later ones were left with was with this one.
                found[i..].iter_mut().for_each(|later| later.gap = None);
                model = without;
            }
        }
    }
    Ok(Explained {
        model,
        found,
        refused,
    })
}
