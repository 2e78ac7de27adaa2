//! Ranges of clearances where the model is wrong.
//!
//! No law of contact is quite a machine's. The size of the model's discrepancy is estimated from the recordings as an
//! error of timing (Kennedy and O'Hagan 2001): orders count as far as they do not turn over it. Where no more is left
//! than noise and this error, the likelihood with both has a range of the clearance. Elsewhere no range is known.

use super::effort::Effort;
use crate::error::Error;
use crate::fit::{ADEQUATE, Fit};
use crate::identifiability::{information, widening};
use crate::likelihood::{Likelihood, misfit};
use crate::optimiser::{self, LeastSquares};
use crate::problem::Problem;

/// Sizes of the discrepancy that a model may have, rad.
pub(super) const TIMINGS: [f64; 6] = [0.03, 0.01, 0.003, 0.001, 0.0003, 0.0];
/// Greatest size of a discrepancy that still has a range, rad: beyond it high orders say nothing, and clearances far from
/// each other explain what is left.
const GREATEST: f64 = 0.003;
/// Misfit beyond which no range is given: descents in wrong minima leave as much.
pub(super) const FAR: f64 = 5.0;
/// Relative change of the sum of squares at which the descent ends.
const CHANGE: f64 = 1e-4;
/// Most evaluations of it.
const MOST_STEPS: u64 = 60;

/// What is known of the parameters with a model that is wrong.
pub(super) struct Discrepancy {
    /// The error of timing, rad.
    pub timing: f64,
    /// Coordinates of the parameters, and the ranges that hold them with 95 %.
    pub x: Vec<f64>,
    /// A range per parameter; none where it is not identifiable.
    pub ranges: Vec<Option<[f64; 2]>>,
}

/// The discrepancy of a fitted model; none where the recordings contradict a timing error of the sizes looked at.
///
/// # Errors
/// A machine that cannot be simulated.
pub(super) fn discrepancy(
    problem: &Problem,
    fit: &Fit,
    effort: &mut Effort,
) -> Result<Option<Discrepancy>, Error> {
    let x = fit.coordinates();
    if fit
        .misfit(false, |run| run.calibrated)
        .is_none_or(|left| left > FAR)
    {
        return Ok(None);
    }
    let (timing, _) = Likelihood::new(problem).likeliest(&x, &TIMINGS)?;
    if timing == 0.0 || timing > GREATEST {
        return Ok(None);
    }
    let known: Vec<usize> = (0..x.len())
        .filter(|i| fit.estimates[*i].interval.is_some())
        .collect();
    let part = problem.with_parameters(&known);
    let likelihood = Likelihood::coarse(&part, timing);
    let start: Vec<f64> = known.iter().map(|i| x[*i]).collect();
    let mut watch = |progress: &optimiser::Progress| effort.shown(progress.evaluations);
    let found =
        optimiser::levenberg_marquardt(&likelihood, &start, CHANGE, MOST_STEPS, &mut watch)?;
    let left = misfit(&likelihood.residuals(&found.x));
    if effort.stopped || left > ADEQUATE {
        return Ok(None);
    }
    let mut all = x.clone();
    for (i, x) in known.iter().zip(&found.x) {
        all[*i] = *x;
    }
    let factors = widening(&Likelihood::coarse(problem, timing), &all, &known);
    let information = information(&likelihood, &found.x).widened(&factors, &found.x);
    let mut ranges = vec![None; x.len()];
    for (i, range) in known.iter().zip(&information.intervals) {
        ranges[*i] = Some(*range);
    }
    Ok(Some(Discrepancy {
        timing,

        x: all,
        ranges,
    }))
}
