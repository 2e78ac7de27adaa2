//! A candidate so like the effect that was chosen that the screening may have taken one for the other.
//!
//! Only the most promising candidates are fitted. Beside the effect that did best of them its look-alikes
//! have their chance where it leaves more than the noise.

use crate::decision::{earns, evidence};
use crate::error::{Error, possible};
use crate::explain::{Search, Tried, effects};
use crate::model::Model;
use crate::replication::shows_in_each;

/// A misfit below this leaves nothing that another effect would explain.
const AT_THE_NOISE: f64 = 1.0;
/// Most that are fitted.
const MOST: usize = 2;

impl Search<'_> {
    /// The one that comes nearer to the recordings than the effect of `after`, with its model: of its
    /// `rivals`, if it is alike and not one of those that were `fitted`. `before` has all runs without
    /// the effect, `few` some of them.
    pub(crate) fn look_alike(
        &self,
        [before, few, after]: [&Model; 3],
        fitted: &[Tried],
        rivals: &[Tried],
    ) -> Result<Option<(Tried, Model)>, Error> {
        if after.fitted <= AT_THE_NOISE {
            return Ok(None);
        }
        let passed_over = |rival: &&Tried| {
            rival.is_alike() && !fitted.iter().any(|f| f.candidate == rival.candidate)
        };
        let runs = &few.problem.runs;
        let same = after
            .problem
            .with_runs(|run| runs.iter().any(|own| own.id == run.id));
        let chosen = Model::at(same, after.x.clone(), self.effort)?;
        for rival in rivals.iter().filter(passed_over).take(MOST) {
            if !self.effort.goes_on() {
                break;
            }
            let mut rival = rival.clone();
            if rival.model.is_none() {
                self.fit_rival(few, after, &mut rival)?;
            }
            let Some(rough) = rival.model.take_if(|m| m.criterion() < chosen.criterion()) else {
                continue;
            };
            let added = rival.candidate.added(&before.problem, &rival.values)?;
            let mut x = rough.x[..before.x.len()].to_vec();
            x.resize(added.parameters.len(), 0.0);
            let Some(model) = possible(Model::fit(added, &x, self.effort, self.watch))? else {
                continue;
            };
            let holds = earns(before, &model) && shows_in_each(&rival.candidate, before, &model);
            if holds && model.criterion() < after.criterion() {
                let tried = Tried {
                    values: rival.candidate.values(&model, effects(&before.problem)),
                    evidence: evidence(before, &model, rival.evidence.score),
                    by_run: model.misfits(),
                    likeness: None,
                    model: Some(model.clone()),
                    candidate: rival.candidate,
                };
                return Ok(Some((tried, model)));
            }
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::confusability::Likeness;
    use crate::linearised::tests::{candidate, effort, problem};
    use std::ops::ControlFlow;

    #[test]
    fn what_the_screening_passed_over_is_fitted_where_it_is_like_the_effect() {
        let problem = problem();
        let effort = effort();
        let search = Search {
            effort: &effort,
            watch: &|| ControlFlow::Continue(()),
            say: &|_, _| (),
        };
        let candidate = |name: &str| candidate(&problem, name);
        let before = Model::at(problem.clone(), vec![0.0], &effort).unwrap();
        let force = candidate("misalignment");
        let added = force.added(&problem, &[100.0, 0.0, 50.0, 0.0]).unwrap();
        let chosen = Model::fit(added, &[0.0; 5], &effort, search.watch).unwrap();
        // Another force of the same size as the friction that is missing.
        let rings = |correlation: f64| Tried {
            candidate: candidate("ring_friction"),
            values: vec![120.0, 1e-9, 0.01],
            evidence: evidence(&before, &chosen, 0.5),
            by_run: Vec::new(),
            likeness: Some(Likeness {
                correlation,
                leaves: chosen.fitted,
            }),
            model: None,
        };
        let models = [&before, &before, &chosen];
        let found =
            |fitted: &[Tried], rival: Tried| search.look_alike(models, fitted, &[rival]).unwrap();
        let (tried, model) = found(&[], rings(0.95)).unwrap();
        assert_eq!(tried.candidate.entry.name, "ring_friction");
        assert!(model.fitted < 0.3 * chosen.fitted, "{}", model.fitted);
        assert_eq!(tried.evidence.misfit, [before.fitted, model.fitted]);
        assert!(found(&[], rings(0.8)).is_none());
        assert!(found(&[rings(0.95)], rings(0.95)).is_none());
        let models = [&before, &before, &model];
        let at_the_noise = search.look_alike(models, &[], &[rings(0.95)]).unwrap();
        assert!(at_the_noise.is_none());
    }
}
