//! Which candidates are worth a fit: a score test at finite amplitudes.
//!
//! A candidate changes the predicted features by Δ. What the calibrated parameters could imitate of
//! it, and of the residual r, is projected out (P, with a prior of one unit of their coordinates).
//! The score is the share of the residual that the rest explains at its best amplitude:
//!
//! ```text
//! 1 − min_a |P (r + a Δ)|² / |P r|²
//! ```
//!
//! (Rao 1948; finite amplitudes because the linear test misses effects that saturate.)

use crate::candidate::Candidate;
use crate::error::Error;
use crate::fitter::{Fitter, loose};
use crate::journal::Finished;
use crate::model::Model;
use crate::moves::projector::Projector;
use crate::recorded::is_of_pressures;
use calibrate::likelihood::Likelihood;
use calibrate::optimiser::LeastSquares;
use nalgebra::DVector;
use rayon::prelude::*;

/// A probe is not scaled by more than this: further away the change is another one.
const SCALED: f64 = 2.0;
/// A calibrated coordinate further than this from the nominal one may have gone astray, where this misfit
/// is left. With less left, only small effects can be missing.
const ASTRAY: f64 = 0.1;
const MUCH_LEFT: f64 = 3.0;
/// The best of each point at which candidates are screened come before all others. Their shares at
/// different points cannot be compared.
const LEADING: usize = 2;

/// A candidate and how much of the residual it may explain.
#[derive(Clone, Debug)]
pub(crate) struct Screened {
    /// The candidate.
    pub candidate: Candidate,
    /// Share of the residual's sum of squares, 0 to 1, that it explains where it does most.
    pub score: f64,
    /// Where a fit may start.
    pub starts: Vec<Start>,
}

/// A point to start from: the calibrated machine with an effect, or the nominal one.
#[derive(Clone, Debug)]
pub(crate) struct Start {
    /// Coordinates of the calibrated parameters.
    pub x: Vec<f64>,
    /// Parameters of the effect, SI.
    pub values: Vec<f64>,
}

/// A point at which candidates are looked at, and what is left there.
struct Base {
    x: Vec<f64>,
    residual: DVector<f64>,
    projector: Projector,
    left: DVector<f64>,
}

impl Base {
    fn at(likelihood: &Likelihood, x: &[f64]) -> Self {
        let residual = DVector::from_vec(likelihood.residuals(x));
        let projector = Projector::new(&likelihood.jacobian(x));
        Self {
            x: x.to_vec(),
            left: projector.apply(&residual),
            residual,
            projector,
        }
    }

    /// The score of a probe that has these residuals.
    fn score(&self, there: Vec<f64>) -> Option<f64> {
        let change = (self.projector).apply(&(DVector::from_vec(there) - &self.residual));
        let size = change.norm_squared();
        (size > 0.0).then(|| {
            let share = (-self.left.dot(&change) / size).clamp(0.0, SCALED);
            let left = (&self.left + share * &change).norm_squared();
            1.0 - left / self.left.norm_squared()
        })
    }
}

/// The candidates, the most promising first. Those that cannot be simulated are left out. They are
/// looked at where the machine is calibrated, and where it is nominal: without what is missing a
/// calibration may have gone far astray.
///
/// # Errors
/// [`Error::Stopped`].
pub(crate) fn screen(
    fitter: &Fitter,
    model: &Model,
    candidates: Vec<Candidate>,
) -> Result<Vec<Screened>, Error> {
    let loose = loose(&model.problem);
    let likelihood = Likelihood::coarse(&model.problem, loose);
    let mut bases = vec![Base::at(&likelihood, &model.x)];
    let may_be_astray = model.fitted > MUCH_LEFT && model.x.iter().any(|x| x.abs() > ASTRAY);
    if may_be_astray && !is_of_pressures(&model.problem) {
        bases.push(Base::at(&likelihood, &vec![0.0; model.x.len()]));
    }
    // The score and the values there; nothing for what cannot be simulated.
    let of = |candidate: &Candidate, base: &Base| -> Result<Finished, Error> {
        let mut best: Option<(f64, Vec<f64>)> = None;
        let metered = model.problem.metered();
        for values in candidate.probes(&model.problem) {
            if (fitter.watch)().is_break() {
                return Err(Error::Stopped);
            }
            let Ok(added) = candidate.added(&metered, &values) else {
                continue;
            };
            let mut x = base.x.clone();
            x.resize(added.parameters.len(), 0.0);
            let there = Likelihood::coarse(&added, loose).residuals(&x);
            let score = base.score(there);
            let better = |score: &f64| best.as_ref().is_none_or(|(best, _)| score > best);
            if let Some(score) = score.filter(better) {
                best = Some((score, values));
            }
        }
        let found = best.into_iter();
        let numbers = found.flat_map(|(score, values)| [vec![score], values].concat());
        Ok(Finished {
            numbers: numbers.collect(),
            cost: metered.meter.steps(),
        })
    };
    let screened = candidates.into_par_iter().map(|candidate| {
        let (mut scores, mut starts) = (vec![f64::NEG_INFINITY; bases.len()], Vec::new());
        for (base, best) in bases.iter().zip(&mut scores) {
            let input = ("screen", &model.problem, &base.x, candidate.label());
            let numbers = fitter
                .effort
                .journal
                .once(&input, || of(&candidate, base))?;
            if let Some((score, values)) = numbers.split_first() {
                *best = *score;
                starts.push(Start {
                    x: base.x.clone(),
                    values: values.to_vec(),
                });
            }
        }
        let screened = Screened {
            candidate,
            score: scores.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            starts,
        };
        Ok((!screened.starts.is_empty()).then_some((screened, scores)))
    });
    let screened = screened.collect::<Result<Vec<_>, Error>>()?;
    Ok(ordered(screened.into_iter().flatten().collect()))
}

/// The most promising first, by the scores that they have at each point.
fn ordered<T>(mut scored: Vec<(T, Vec<f64>)>) -> Vec<T> {
    let greatest = |scores: &[f64]| scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    scored.sort_by(|(_, a), (_, b)| greatest(b).total_cmp(&greatest(a)));
    let leads = |scores: &[f64]| {
        scores.iter().enumerate().any(|(point, score)| {
            let better = scored.iter().filter(|(_, other)| other[point] > *score);
            better.count() < LEADING
        })
    };
    let leading: Vec<bool> = scored.iter().map(|(_, scores)| leads(scores)).collect();
    let (first, others): (Vec<_>, Vec<_>) =
        (scored.into_iter().zip(leading)).partition(|(_, l)| *l);
    first
        .into_iter()
        .chain(others)
        .map(|((it, _), _)| it)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_of_each_point_come_first() {
        let scored = vec![
            ("only where it is calibrated", vec![0.09, 0.1]),
            ("worth nothing there", vec![0.0, 0.5]),
            ("nor this", vec![0.0, 0.4]),
            ("nor that", vec![0.0, 0.3]),
            ("a little", vec![0.01, f64::NEG_INFINITY]),
        ];
        let names = ordered(scored);
        let expected = [
            "worth nothing there",
            "nor this",
            "only where it is calibrated",
            "a little",
            "nor that",
        ];
        assert_eq!(names, expected);
    }
}
