//! The most promising candidates, fitted together with everything else.

use crate::candidate::Candidate;
use crate::criteria::{NOISE, RIVAL, closes_most};
use crate::error::{Error, possible};
use crate::finding::Tried;
use crate::fitter::{FEW_EVALUATIONS, Fitter};
use crate::model::Model;
use crate::moves::screen::Screened;
use rayon::prelude::*;

/// Candidates that are fitted, of those that were screened: the linear score may be wrong.
const FITTED: usize = 8;
/// How many are fitted at once, before it is looked whether one has reached the noise.
const TOGETHER: usize = 2;
/// How many are fitted after one has reached the noise, itself included: its rivals.
const AFTERWARDS: usize = 6;
/// Of these, how many are fitted to all runs.
const FINAL: usize = 3;
/// How many are searched further where none has reached the noise, and the evaluations of it.
const DEEPER: usize = 3;
const SEARCH: u64 = 300;
/// Most evaluations of a first descent for a candidate that can be more than a rival of another.
const FIRST: u64 = 50;

/// The most promising candidates, each fitted to `few` runs together with everything else, the best
/// first.
pub(crate) fn roughly(
    fitter: &Fitter,
    few: &Model,
    screened: Vec<Screened>,
) -> Result<Vec<Rough>, Error> {
    let mut rough: Vec<Rough> = Vec::new();
    let mut chosen = screened.into_iter().take(FITTED).peekable();
    while chosen.peek().is_some() {
        let together: Vec<Screened> = chosen.by_ref().take(TOGETHER).collect();
        let near = rough.iter().position(|rough| rough.model.fitted < NOISE);
        let done = near.is_some_and(|i| rough.len() - i >= AFTERWARDS);
        if done || (!rough.is_empty() && !fitter.effort.goes_on()) {
            break;
        }
        let near = near.map(|i| rough[i].model.clone());
        let fitted = together
            .into_par_iter()
            .map(|screened| candidate(fitter, few, &screened, near.as_ref()));
        let fitted = fitted.collect::<Result<Vec<_>, Error>>()?;
        rough.extend(fitted.into_iter().flatten());
    }
    sort(&mut rough);
    Ok(rough)
}

/// The same, with the best few searched further where none has reached the noise. Only the best is where it closes
/// most of the gap, for the rest is then likely another effect's.
pub(crate) fn further(
    fitter: &Fitter,
    few: &Model,
    mut rough: Vec<Rough>,
) -> Result<Vec<Rough>, Error> {
    let Some(best) = rough.first().map(|best| best.model.fitted) else {
        return Ok(rough);
    };
    if best <= NOISE {
        return Ok(rough);
    }
    let deeper = match closes_most([few.fitted, best]) {
        true => 1,
        false => DEEPER,
    };
    let later = rough.split_off(rough.len().min(deeper));
    let deeper = rough.into_par_iter().map(|rough| {
        let model = searched_further(fitter, rough.model)?;
        Ok(Rough { model, ..rough })
    });
    rough = deeper.collect::<Result<Vec<_>, Error>>()?;
    rough.extend(later);
    sort(&mut rough);
    Ok(rough)
}

/// The best of the candidates that were fitted to the runs of `few`, fitted to all runs of `model`, the
/// best first.
pub(crate) fn refit(
    fitter: &Fitter,
    model: &Model,
    few: &Model,
    rough: Vec<Rough>,
) -> Result<Vec<(Tried, Model)>, Error> {
    let least = rough.first().map_or(f64::NAN, |best| best.model.fitted);
    let mut tried = Vec::new();
    for (i, rough) in rough.into_iter().enumerate() {
        let Rough {
            candidate,
            score,
            values,
            model: fitted,
        } = rough;
        let close = fitted.fitted < RIVAL * least.max(1.0);
        let (before, after) = if tried.is_empty() || (i < FINAL && close) {
            (fitter.say)(&candidate.label(), fitted.fitted);
            let added = candidate.added(&model.problem, &values)?;
            match possible(fitter.fit(added, &fitted.x))? {
                Some(after) => (model, after),
                None => continue,
            }
        } else {
            (few, fitted)
        };
        tried.push((Tried::fitted(candidate, before, &after, score), after));
    }
    let order = |tried: &(Tried, Model)| tried.1.criterion();
    let whole = |tried: &&(Tried, Model)| tried.1.problem.runs.len() == model.problem.runs.len();
    let last = tried.iter().take_while(whole).count();
    tried[..last].sort_by(|a, b| order(a).total_cmp(&order(b)));
    Ok(tried)
}

/// The best that a search from this model finds: out of the local minima of a ringing whose pitch
/// is wrong.
fn searched_further(fitter: &Fitter, model: Model) -> Result<Model, Error> {
    (fitter.say)("searching further", model.fitted);
    let found = possible(fitter.searched(&model.problem, Some(model.x.clone()), SEARCH))?;
    Ok(match found {
        None => model,
        Some(found) => model.better(found),
    })
}

/// A candidate fitted to `few` runs together with everything else. Where another one has reached
/// the noise, what the calibrated parameters are is known from it. None where it cannot be simulated.
fn candidate(
    fitter: &Fitter,
    few: &Model,
    screened: &Screened,
    near: Option<&Model>,
) -> Result<Option<Rough>, Error> {
    let Screened {
        candidate,
        score,
        starts,
    } = screened;
    let label = candidate.label();
    (fitter.say)(&label, few.fitted);
    let most = if near.is_some() {
        FEW_EVALUATIONS
    } else {
        FIRST
    };
    let most = most.min(fitter.effort.evaluations);
    let mut best: Option<(Vec<f64>, Model)> = None;
    // Where the calibration is known, the start at the nominal machine is the nearer one.
    let known = if near.is_some() { starts.len() - 1 } else { 0 };
    for start in &starts[known..] {
        let added = candidate.added(&few.problem, &start.values)?;
        let x = &near.map_or(&start.x, |near| &near.x)[..few.x.len()];
        let Some(model) = possible(fitter.fit_within(added, x, most))? else {
            continue;
        };
        if best
            .as_ref()
            .is_none_or(|(_, best)| model.fitted < best.fitted)
        {
            best = Some((start.values.clone(), model));
        }
    }
    let Some((values, model)) = best else {
        return Ok(None);
    };
    (fitter.say)(&format!("{label} fitted"), model.fitted);
    Ok(Some(Rough {
        candidate: candidate.clone(),
        score: *score,
        values,
        model,
    }))
}

/// A candidate fitted to a few runs.
pub(crate) struct Rough {
    pub candidate: Candidate,
    pub score: f64,
    /// Its parameters where their coordinates are 0, SI.
    pub values: Vec<f64>,
    pub model: Model,
}

/// The best first.
fn sort(rough: &mut [Rough]) {
    rough.sort_by(|a, b| a.model.criterion().total_cmp(&b.model.criterion()));
}
