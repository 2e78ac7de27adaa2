//! A candidate so like the effect that was chosen that the screening may have taken one for the other.
//!
//! Only the most promising candidates are fitted. Beside the effect that did best of them its look-alikes
//! have their chance where it leaves more than the noise.

use crate::criteria::earns;
use crate::error::{Error, possible};
use crate::finding::Tried;
use crate::fitter::Fitter;
use crate::model::Model;
use crate::moves::signature::fit_rival;
use crate::search::replication::shows_in_each;

/// A misfit below this leaves nothing that another effect would explain.
const AT_THE_NOISE: f64 = 1.0;
/// Most that are fitted.
const MOST: usize = 2;

/// The one of `rivals` that reduces the residual further than the effect of `after`, with its model. Only
/// a rival that is alike and not one of those that were `fitted` is tried. `before` has all runs without
/// the effect, `few` some of them.
pub(crate) fn look_alike(
    fitter: &Fitter,
    [before, few, after]: [&Model; 3],
    fitted: &[Tried],
    rivals: &[Tried],
) -> Result<Option<(Tried, Model)>, Error> {
    if after.fitted <= AT_THE_NOISE {
        return Ok(None);
    }
    let passed_over =
        |rival: &&Tried| rival.is_alike() && !fitted.iter().any(|f| f.candidate == rival.candidate);
    let runs = &few.problem.runs;
    let same = after
        .problem
        .with_runs(|run| runs.iter().any(|own| own.id == run.id));
    let chosen = Model::at(same, &after.x, fitter.effort)?;
    for rival in rivals.iter().filter(passed_over).take(MOST) {
        if !fitter.effort.goes_on() {
            break;
        }
        let mut rival = rival.clone();
        if rival.model.is_none() {
            fit_rival(fitter, few, after, &mut rival)?;
        }
        let Some(rough) = rival.model.take_if(|m| m.criterion() < chosen.criterion()) else {
            continue;
        };
        let added = rival.candidate.added(&before.problem, &rival.values)?;
        let Some(model) = possible(fitter.fit(added, &rough.x[..before.x.len()]))? else {
            continue;
        };
        let holds = earns(before, &model) && shows_in_each(&rival.candidate, before, &model);
        if holds && model.criterion() < after.criterion() {
            let score = rival.evidence.score;
            let tried = Tried::fitted(rival.candidate, before, &model, score);
            return Ok(Some((tried, model)));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidate::Candidate;
    use crate::criteria::evidence;
    use crate::finding::Likeness;
    use crate::fixture::{effort, fitter, problem};

    #[test]
    fn what_the_screening_passed_over_is_fitted_where_it_is_like_the_effect() {
        let problem = problem();
        let effort = effort();
        let fitter = fitter(&effort);
        let candidate = |name: &str| Candidate::first(&problem, name);
        let before = Model::at(problem.clone(), &[0.0], &effort).unwrap();
        let force = candidate("misalignment");
        let added = force.added(&problem, &[100.0, 0.0, 50.0, 0.0]).unwrap();
        let chosen = fitter.fit(added, &[]).unwrap();
        // Another force of the same size as the friction that is missing.
        let rings = |correlation: f64| Tried {
            candidate: candidate("ring_friction"),
            values: vec![120.0, 1e-9, 0.01],
            evidence: evidence(&before, &chosen, 0.5),
            likeness: Some(Likeness {
                correlation,
                leaves: chosen.fitted,
            }),
            model: None,
        };
        let models = [&before, &before, &chosen];
        let found =
            |fitted: &[Tried], rival: Tried| look_alike(&fitter, models, fitted, &[rival]).unwrap();
        let (tried, model) = found(&[], rings(0.95)).unwrap();
        assert_eq!(tried.candidate.entry.name, "ring_friction");
        assert!(model.fitted < 0.3 * chosen.fitted, "{}", model.fitted);
        assert_eq!(tried.evidence.misfit, [before.fitted, model.fitted]);
        assert!(found(&[], rings(0.8)).is_none());
        assert!(found(&[rings(0.95)], rings(0.95)).is_none());
        let models = [&before, &before, &model];
        let at_the_noise = look_alike(&fitter, models, &[], &[rings(0.95)]).unwrap();
        assert!(at_the_noise.is_none());
    }
}
