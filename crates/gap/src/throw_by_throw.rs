//! Each throw of several by itself: a machine with half the parameters, and half as dear.

use crate::candidate::Candidate;
use crate::decision::{NOISE, earns};
use crate::error::Error;
use crate::explain::{Found, MOST, Search};
use crate::model::Model;
use calibrate::Problem;
use calibrate::throw_alone::throws_alone;

impl Search<'_> {
    /// The model with the effects that each throw shows by itself, where throws can be taken apart and
    /// the whole is better with them; the model as it is elsewhere.
    pub(crate) fn throw_by_throw(
        &self,
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
            let start = throw.parameters.iter().map(|i| model.x[*i]).collect();
            let throw_model = Model::at(throw.problem, start, self.effort)?;
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
            let (throw, mut of_throw, _) = self.while_they_earn(throw, NOISE, most, own)?;
            if of_throw.is_empty() {
                continue;
            }
            let mut with = explained.problem.clone();
            for found in &of_throw {
                with = found.candidate.added(&with, &found.values)?;
            }
            let mut x = explained.x.clone();
            for (i, own) in parameters.iter().zip(&throw.x) {
                x[*i] = *own;
            }
            x.resize(with.parameters.len(), 0.0);
            let after = Model::fit(with, &x, self.effort, self.watch)?;
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
}
