//! Which candidates are worth a fit: a score test at finite amplitudes.
//!
//! A candidate changes the predicted features by Δ. What the calibrated parameters could imitate of
//! it, and of the residual r, is projected out (P, with a prior of one unit of their coordinates);
//! the score is the share of the residual that the rest explains at its best amplitude:
//!
//! ```text
//! 1 − min_a |P (r + a Δ)|² / |P r|²
//! ```
//!
//! (Rao 1948; finite amplitudes because the linear test misses effects that saturate.)

use crate::candidate::Candidate;
use crate::error::Error;
use crate::journal::Finished;
use crate::model::{Effort, Model, Watch, loose};
use calibrate::likelihood::Likelihood;
use calibrate::optimiser::LeastSquares;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// A probe is not scaled by more than this: further away the change is another one.
const SCALED: f64 = 2.0;

/// A candidate and how much of the residual it may explain.
#[derive(Clone, Debug)]
pub struct Screened {
    /// The candidate.
    pub candidate: Candidate,
    /// Share of the residual's sum of squares, 0 to 1, that it explains where it does most.
    pub score: f64,
    /// Its parameters there, SI.
    pub values: Vec<f64>,
}

/// The candidates, the most promising first. Those that cannot be simulated are left out.
///
/// # Errors
/// [`Error::Stopped`].
pub fn screen(
    model: &Model,
    candidates: Vec<Candidate>,
    effort: &Effort,
    watch: Watch,
) -> Result<Vec<Screened>, Error> {
    let loose = loose(&model.problem);
    let likelihood = Likelihood::coarse(&model.problem, loose);
    let residual = DVector::from_vec(likelihood.residuals(&model.x));
    let projector = Projector::new(&likelihood.jacobian(&model.x));
    let base = projector.apply(&residual);
    let cost = effort.cost(&model.problem)?;
    // The score and the values there; nothing for what cannot be simulated.
    let of = |candidate: &Candidate| -> Result<Finished, Error> {
        let mut best: Option<(f64, Vec<f64>)> = None;
        let probes = candidate.probes();
        let cost = cost * probes.len() as u64;
        for values in probes {
            if watch().is_break() {
                return Err(Error::Stopped);
            }
            let Ok(added) = candidate.added(&model.problem, &values) else {
                continue;
            };
            let mut x = model.x.clone();
            x.resize(added.parameters.len(), 0.0);
            let there = Likelihood::coarse(&added, loose).residuals(&x);
            let change = projector.apply(&(DVector::from_vec(there) - &residual));
            let size = change.norm_squared();
            if size <= 0.0 {
                continue;
            }
            let share = (-base.dot(&change) / size).clamp(0.0, SCALED);
            let left = (&base + share * &change).norm_squared() / base.norm_squared();
            if best.as_ref().is_none_or(|(score, _)| 1.0 - left > *score) {
                best = Some((1.0 - left, values));
            }
        }
        let found = best.into_iter();
        let numbers = found.flat_map(|(score, values)| [vec![score], values].concat());
        Ok(Finished {
            numbers: numbers.collect(),
            cost,
        })
    };
    let screened = candidates.into_par_iter().map(|candidate| {
        let input = ("screen", &model.problem, &model.x, candidate.label());
        let numbers = effort.journal.once(&input, || of(&candidate))?;
        let found = numbers
            .split_first()
            .map(|(score, values)| (*score, values.to_vec()));
        Ok(found.map(|(score, values)| Screened {
            candidate,
            score,
            values,
        }))
    });
    let screened = screened.collect::<Result<Vec<_>, Error>>()?;
    let mut screened: Vec<Screened> = screened.into_iter().flatten().collect();
    screened.sort_by(|a, b| b.score.total_cmp(&a.score));
    Ok(screened)
}

/// Takes from residuals what a step of the calibrated parameters can.
struct Projector {
    jacobian: DMatrix<f64>,
    inverse: DMatrix<f64>,
}

impl Projector {
    fn new(jacobian: &DMatrix<f64>) -> Self {
        let count = jacobian.ncols();
        let mut normal = jacobian.tr_mul(jacobian);
        for i in 0..count {
            normal[(i, i)] += 1.0;
        }
        Self {
            jacobian: jacobian.clone(),
            inverse: normal
                .try_inverse()
                .unwrap_or_else(|| DMatrix::zeros(count, count)),
        }
    }

    fn apply(&self, residual: &DVector<f64>) -> DVector<f64> {
        let step = &self.inverse * self.jacobian.tr_mul(residual);
        residual - &self.jacobian * step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_parameters_can_imitate_is_taken_out() {
        let jacobian = DMatrix::from_row_slice(3, 1, &[1e4, 0.0, 1e4]);
        let projector = Projector::new(&jacobian);
        let left = projector.apply(&DVector::from_vec(vec![2.0, 5.0, 4.0]));
        // The mean of the first and the last is a step of the parameter.
        for (left, expected) in left.iter().zip([-1.0, 5.0, 1.0]) {
            assert!((left - expected).abs() < 1e-6, "{left}");
        }
    }

    #[test]
    fn a_weak_parameter_imitates_no_more_than_its_prior_lets_it() {
        let jacobian = DMatrix::from_row_slice(2, 1, &[1e-3, 0.0]);
        let left = Projector::new(&jacobian).apply(&DVector::from_vec(vec![3.0, 1.0]));
        assert!((left[0] - 3.0).abs() < 1e-5);
    }
}
