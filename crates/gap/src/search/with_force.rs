//! A force of no name where the effects that were found leave too much, or the effect that it is.

use crate::candidate::Candidate;
use crate::criteria::{Verdict, earns, verdict};
use crate::error::{Error, possible};
use crate::finding::{Explained, Found, Tried, with_only};
use crate::fitter::Fitter;
use crate::model::Model;
use crate::moves::force::empirical_force;
use crate::moves::force_match::{Matched, matched};
use crate::moves::missing_force::MissingForce;
use crate::moves::screen::screen;
use crate::moves::signature::rivals;
use crate::recorded::{is_of_pressures, shows_pressure};
use calibrate::Problem;

/// By how much more an effect with a name may leave than a law without one.
const HARDLY_MORE: f64 = 1.1;

/// What the search of a force made of an explanation.
pub(crate) struct WithForce {
    /// The model, with a law of the force where there is one, and its effects.
    pub explained: Explained,
    /// The force that is missing; empty where none was looked for.
    pub missing: Vec<MissingForce>,
    /// Whether a force of no name in the place of the effects reduces the residual of most recordings further.
    pub nearer: bool,
}

/// The model with an empirical force in place of the effects that were found beside the gas, or
/// on top of them. It is tried only where they leave too much and the force predicts what they do not.
pub(crate) fn with_force(
    fitter: &Fitter,
    problem: &Problem,
    baseline: &Model,
    explained: Explained,
) -> Result<WithForce, Error> {
    let comes_to = verdict(baseline, &explained.model, explained.found.len());
    // Where a part is left the force must have its chance even if the budget is spent. Otherwise the best
    // effect of the catalogue stands for it.
    let settled = matches!(comes_to, Verdict::NoGap | Verdict::Explained);
    // Pressures do not feel it, and without derivatives there is no regression.
    if settled || is_of_pressures(problem) || fitter.effort.chaotic {
        return Ok(WithForce {
            explained,
            missing: Vec::new(),
            nearer: false,
        });
    }
    let Explained {
        mut model,
        mut found,
        refused,
    } = explained;
    let effort = &fitter.effort.having(found.len());
    let mut starts = vec![gas_alone(fitter, problem, baseline, &model, &found)?];
    if starts[0].1.len() < found.len() {
        starts.push((model.clone(), found.clone()));
    }
    let (mut missing, mut nearer) = (Vec::new(), false);
    for (i, (start, mut effects)) in starts.into_iter().enumerate() {
        if i > 0 && !effort.goes_on_for_force() {
            break;
        }
        let Some(force) = empirical_force(&fitter.having(effort), &start)? else {
            continue;
        };
        // On top of all effects it is always nearer.
        let in_their_place = effects.len() < found.len();
        nearer |= in_their_place && is_nearer(&force.all.misfits(), &model.misfits());
        missing = force.missing;
        let explains = |after: &Model| verdict(baseline, after, effects.len() + 1);
        let law = force.law.as_ref().map(|(_, model)| model);
        let named = named_instead(fitter, &start, law.unwrap_or(&force.all), |after| {
            explains(after) == Verdict::Explained || law.is_some_and(|law| does_as_well(after, law))
        })?;
        // What the catalogue has a name for needs no law.
        let lawful = |(law, after): (Tried, Model)| (Found::new(law, &after, Vec::new()), after);
        let Some((added, after)) = named.or(force.law.map(lawful)) else {
            continue;
        };
        let verdict = explains(&after);
        let closes = matches!(verdict, Verdict::Explained | Verdict::PartlyExplained);
        let predicts = after.held_out.is_some() && earns(&start, &after);
        if !(closes && predicts && earns(&model, &after)) {
            continue;
        }
        effects.push(added);
        (model, found, nearer) = (after, effects, false);
        if verdict == Verdict::Explained {
            break;
        }
    }
    Ok(WithForce {
        explained: Explained {
            model,
            found,
            refused,
        },
        missing,
        nearer,
    })
}

/// The model with only those of its effects that the pressures show independently of what acts on the
/// crosshead.
fn gas_alone(
    fitter: &Fitter,
    problem: &Problem,
    baseline: &Model,
    model: &Model,
    found: &[Found],
) -> Result<(Model, Vec<Found>), Error> {
    let mut kept = found.to_vec();
    kept.retain(|f| shows_pressure(problem) && f.candidate().is_of_gas());
    match kept.len() == found.len() {
        true => Ok((model.clone(), kept)),
        false => Ok((with_only(fitter, problem, baseline, &kept)?, kept)),
    }
}

/// The effect of the catalogue with the smallest residual of those that make the force of
/// `with_force`, which has one effect more than `start`; and the model with it in its place. None
/// where that is not `enough`.
fn named_instead(
    fitter: &Fitter,
    start: &Model,
    with_force: &Model,
    enough: impl Fn(&Model) -> bool,
) -> Result<Option<(Found, Model)>, Error> {
    (fitter.say)("looking for a name of the force", with_force.fitted);
    let known = shows_pressure(&start.problem);
    let mut candidates = Candidate::all(&start.problem);
    candidates.retain(|c| !(known && c.is_of_gas()));
    let mut tried = Vec::new();
    let x = &with_force.x[..start.x.len()];
    for matched in matched(fitter, start, with_force, &candidates)? {
        let Matched {
            candidate,
            values,
            share,
        } = matched;
        let added = candidate.added(&start.problem, &values)?;
        if let Some(after) = possible(fitter.fit(added, x))? {
            tried.push((Tried::fitted(candidate, start, &after, share), after));
        }
    }
    tried.sort_by(|(_, a), (_, b)| a.criterion().total_cmp(&b.criterion()));
    let mut tried = tried.into_iter();
    let Some((best, after)) = tried.next().filter(|(_, after)| enough(after)) else {
        return Ok(None);
    };
    let few = fitter.few(start)?;
    let screened = screen(fitter, &few, candidates)?;
    let others: Vec<Tried> = tried.map(|(tried, _)| tried).collect();
    let rivals = rivals(fitter, &few, &after, &best, &screened, &others)?;
    Ok(Some((Found::new(best, &after, rivals), after)))
}

/// Whether a model leaves hardly more than another, of fitted and of held-out runs.
fn does_as_well(model: &Model, other: &Model) -> bool {
    let held_out = model.held_out.zip(other.held_out);
    model.fitted <= HARDLY_MORE * other.fitted
        && held_out.is_none_or(|(model, other)| model <= HARDLY_MORE * other)
}

/// Whether what a force `leaves` in its runs is less than the `misfits` in most of these.
fn is_nearer(leaves: &[(String, f64)], misfits: &[(String, f64)]) -> bool {
    let nearer = leaves.iter().filter(|(run, leaves)| {
        let mut same = misfits.iter().filter(|(id, _)| id == run);
        same.any(|(_, misfit)| leaves < misfit)
    });
    2 * nearer.count() > leaves.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_is_nearer_where_it_leaves_less_in_most_of_its_runs() {
        let runs = |misfits: &[(&str, f64)]| -> Vec<(String, f64)> {
            let named = misfits
                .iter()
                .map(|(run, misfit)| ((*run).to_owned(), *misfit));
            named.collect()
        };
        let force = runs(&[("a", 15.8), ("b", 3.0), ("c", 2.6)]);
        let model = runs(&[("a", 6.7), ("x", 1.0), ("b", 5.5), ("c", 5.3)]);
        assert!(is_nearer(&force, &model));
        assert!(!is_nearer(&force, &model[..3]));
        assert!(!is_nearer(&force, &runs(&[("b", 2.9), ("c", 5.3)])));
    }
}
