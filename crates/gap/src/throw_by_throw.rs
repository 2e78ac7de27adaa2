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
        let mut x = model.x.clone();
        let mut found: Vec<Found> = Vec::new();
        for throw in throws_alone(&model.problem)? {
            let most = MOST.saturating_sub(found.len());
            let start = throw.parameters.iter().map(|i| model.x[*i]).collect();
            let alone = Model::at(throw.problem, start, self.effort)?;
            let (alone, of_throw, _) = self.while_they_earn(alone, NOISE, most, &own)?;
            if !of_throw.is_empty() {
                for (i, own) in throw.parameters.iter().zip(&alone.x) {
                    x[*i] = *own;
                }
                found.extend(of_throw);
            }
        }
        if found.is_empty() {
            return Ok((model, found));
        }
        let mut with = model.problem.clone();
        for found in &found {
            with = found.candidate.added(&with, &found.values)?;
        }
        x.resize(with.parameters.len(), 0.0);
        let after = Model::fit(with, &x, self.effort, self.watch)?;
        match earns(&model, &after) {
            true => Ok((after, found)),
            false => Ok((model, Vec::new())),
        }
    }
}
