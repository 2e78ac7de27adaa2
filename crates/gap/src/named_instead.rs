//! An effect of the catalogue in the place of a force of no name.
//!
//! Without what is missing a calibration may go far astray, and from there neither the score of the true
//! effect nor a descent with it is worth much. A force of no name that comes near the recordings leaves
//! the joints near to what they are. Looked at from there, the catalogue may have a name for it.

use crate::candidate::Candidate;
use crate::decision::evidence;
use crate::empirical_force::NAME;
use crate::error::Error;
use crate::explain::{Search, Tried};
use crate::model::Model;
use crate::pressures::shows_pressure;
use crate::refit::few;
use crate::screening::screen;

/// How many candidates are fitted.
const FITTED: usize = 4;

impl Search<'_> {
    /// The effect of the catalogue that comes nearest, added to `start` in the place of a force with which
    /// the calibrated parameters have the coordinates `x`.
    pub(crate) fn named_instead(
        &self,
        start: &Model,
        x: &[f64],
    ) -> Result<Option<(Tried, Model)>, Error> {
        (self.say)("looking for a name", start.fitted);
        let there = Model::at(start.problem.clone(), x.to_vec(), self.effort)?;
        let known = shows_pressure(&start.problem);
        let mut candidates = Candidate::all(&start.problem);
        candidates.retain(|c| c.entry.name != NAME && !(known && c.is_of_gas()));
        let mut screened = screen(
            &few(&there, self.effort),
            candidates,
            self.effort,
            self.watch,
        )?;
        screened.truncate(FITTED);
        let tried = self.refit(&there, screened)?;
        Ok(tried.into_iter().next().map(|(tried, after)| {
            let score = tried.evidence.score;
            let evidence = evidence(start, &after, score);
            (Tried { evidence, ..tried }, after)
        }))
    }
}
