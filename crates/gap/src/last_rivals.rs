//! Rivals of an effect, judged again where more was found after it.
//!
//! When an effect is added, other candidates may leave as much as it does, because all of them leave
//! what is still missing. Beside what was found later they need not.

use crate::confusability::is_rival;
use crate::decision::evidence;
use crate::error::Error;
use crate::explain::{Found, Search, Tried, effects, first_item};
use crate::model::{Effort, Model};
use crate::refit::RIVALS;
use calibrate::Problem;

impl Search<'_> {
    /// The effects of `model`, each with those of its rivals that are rivals beside the other effects, too.
    pub(crate) fn with_last_rivals(
        &self,
        problem: &Problem,
        model: &Model,
        mut found: Vec<Found>,
    ) -> Result<Vec<Found>, Error> {
        for i in 0..found.len() {
            let mut rivals = Vec::new();
            for rival in std::mem::take(&mut found[i].rivals) {
                if is_rival(&rival, &found[i].evidence, model.fitted) {
                    rivals.push(rival);
                } else if let Some(rival) = self.in_place(problem, model, &found, i, &rival)? {
                    rivals.push(rival);
                }
            }
            found[i].rivals = rivals;
        }
        Ok(found)
    }

    /// A rival of the effect `found[which]`, fitted in its place; none where it leaves too much.
    fn in_place(
        &self,
        problem: &Problem,
        model: &Model,
        found: &[Found],
        which: usize,
        rival: &Tried,
    ) -> Result<Option<Tried>, Error> {
        (self.say)(
            &format!("with {} instead", rival.candidate.label()),
            model.fitted,
        );
        let mut without = problem.clone();
        for (i, other) in found.iter().enumerate().filter(|(i, _)| *i != which) {
            let values = other.candidate.values(model, first_item(problem, found, i));
            without = other.candidate.added(&without, &values)?;
        }
        let index = effects(&without);
        // The others stand at what they were found to be, which is their coordinates' 0.
        let mut x = model.x[..problem.parameters.len()].to_vec();
        x.resize(without.parameters.len(), 0.0);
        let before = Model::at(without.clone(), x.clone(), self.effort)?;
        let with = rival.candidate.added(&without, &rival.values)?;
        x.resize(with.parameters.len(), 0.0);
        let effort = Effort {
            evaluations: RIVALS,
            ..self.effort.clone()
        };
        let after = match Model::fit(with, &x, &effort, self.watch) {
            // A descent may end where the machine cannot be simulated.
            Err(Error::Fit(_)) => return Ok(None),
            after => after?,
        };
        let beside = evidence(&before, model, found[which].evidence.score);
        let rival = Tried {
            values: rival.candidate.values(&after, index),
            evidence: evidence(&before, &after, rival.evidence.score),
            by_run: after.misfits(),
            likeness: None,
            model: Some(after),
            ..rival.clone()
        };
        Ok(is_rival(&rival, &beside, model.fitted).then_some(rival))
    }
}
