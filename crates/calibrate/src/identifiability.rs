//! What the recordings tell about each parameter, and what they do not.
//!
//! Near the best fit the likelihood is that of a linear model: its covariance is (JᵀJ)⁻¹, J being
//! the derivatives of the residuals (Fisher's information). Two evaluations per parameter check
//! that: along the direction in which the others follow it, the sum of squares must rise as the
//! linear model says; where it rises less, the bound is moved out (a profile likelihood, with the
//! other parameters optimised to first order).

use crate::likelihood::misfit;
use crate::optimiser::LeastSquares;
use nalgebra::{DMatrix, DVector};

/// Standard deviations that bound 95 % of a normal distribution.
const QUANTILE: f64 = 1.959_964;
/// A bound is moved out by at most this factor; a likelihood that is flatter tells nothing.
const FLATTEST: f64 = 10.0;
/// A parameter is told where its interval is shorter than this share of its search range.
const TOLD: f64 = 0.5;

/// What a fit tells about its parameters, in their coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Information {
    /// 95 % interval of each parameter.
    pub intervals: Vec<[f64; 2]>,
    /// Correlation between each pair.
    pub correlations: DMatrix<f64>,
    /// The parameter that is told least, if its interval is no narrower than half of its range.
    pub untold: Option<usize>,
}

/// The information at the best fit `x`; two evaluations of the model per parameter.
pub fn information(problem: &impl LeastSquares, x: &[f64]) -> Information {
    let residuals = problem.residuals(x);
    // A model that leaves more than noise knows less than its linear form says.
    let excess = misfit(&residuals).max(1.0).powi(2);
    let covariance = covariance(&problem.jacobian(x)) * excess;
    let square = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>() / excess;
    let least = square(&residuals);
    let bounds = problem.bounds();
    let count = x.len();
    let deviation = |i: usize| covariance[(i, i)].sqrt();
    let intervals: Vec<[f64; 2]> = (0..count)
        .map(|i| {
            let direction = covariance.column(i) / deviation(i);
            let reach = |sign: f64| {
                let step = &direction * (sign * QUANTILE);
                let moved: Vec<f64> = x.iter().zip(&step).map(|(x, s)| x + s).collect();
                let inside = moved
                    .iter()
                    .zip(&bounds)
                    .all(|(x, b)| *x >= b[0] && *x <= b[1]);
                let stretch = if inside {
                    let rise = square(&problem.residuals(&moved)) - least;
                    (QUANTILE.powi(2) / rise.max(1e-9))
                        .sqrt()
                        .clamp(1.0, FLATTEST)
                } else {
                    1.0
                };
                x[i] + sign * QUANTILE * deviation(i) * stretch
            };
            [reach(-1.0), reach(1.0)]
        })
        .collect();
    let share = |i: usize| {
        let [low, high] = intervals[i];
        let share = (high - low) / (bounds[i][1] - bounds[i][0]);
        if share.is_finite() {
            share
        } else {
            f64::INFINITY
        }
    };
    let untold = (0..count)
        .max_by(|a, b| share(*a).total_cmp(&share(*b)))
        .filter(|i| share(*i) >= TOLD);
    Information {
        correlations: DMatrix::from_fn(count, count, |i, j| {
            covariance[(i, j)] / (deviation(i) * deviation(j))
        }),
        intervals,
        untold,
    }
}

/// (JᵀJ)⁻¹. A direction that the residuals do not feel gets a variance that is as good as infinite.
fn covariance(jacobian: &DMatrix<f64>) -> DMatrix<f64> {
    let information = jacobian.transpose() * jacobian;
    let decomposed = information.symmetric_eigen();
    let greatest = decomposed.eigenvalues.max().max(f64::MIN_POSITIVE);
    let inverse: DVector<f64> = decomposed
        .eigenvalues
        .map(|value| 1.0 / value.max(1e-14 * greatest).max(1e-12));
    let vectors = &decomposed.eigenvectors;
    vectors * DMatrix::from_diagonal(&inverse) * vectors.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight line through points with unit noise; the third parameter does nothing.
    struct Line;

    impl LeastSquares for Line {
        fn bounds(&self) -> Vec<[f64; 2]> {
            vec![[-10.0, 10.0]; 3]
        }
        fn count(&self) -> usize {
            4
        }
        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            let noise = [0.3, -0.4, 0.1, 0.0];
            (0..4)
                .map(|i| x[0] + x[1] * i as f64 - 1.0 + noise[i])
                .collect()
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::from_fn(4, 3, |i, j| [1.0, i as f64, 0.0][j])
        }
    }

    #[test]
    fn the_intervals_of_a_line_are_the_textbook_s() {
        let information = information(&Line, &[0.97, 0.02, 0.0]);
        // Variances of intercept and slope at 0, 1, 2, 3: 0.7 and 0.2.
        for (i, variance) in [(0, 0.7_f64), (1, 0.2)] {
            let [low, high] = information.intervals[i];
            let expected = QUANTILE * variance.sqrt();
            assert!(
                ((high - low) / 2.0 / expected - 1.0).abs() < 1e-6,
                "{low} {high}"
            );
        }
        let between = information.correlations[(0, 1)];
        assert!(
            (between + 0.3 / (0.7_f64 * 0.2).sqrt()).abs() < 1e-9,
            "{between}"
        );
        assert_eq!(information.untold, Some(2));
    }
}
