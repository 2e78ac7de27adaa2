//! Which parameters are identifiable from the recordings, and how closely.
//!
//! Near the best fit the likelihood is that of a linear model. Its covariance is (JᵀJ)⁻¹, J being
//! the derivatives of the residuals (Fisher's information). Two evaluations per parameter check
//! that. Along the direction in which the others follow the parameter, the sum of squares must rise as the
//! linear model says. Where it rises less, the bound is moved out (a profile likelihood, with the
//! other parameters optimised to first order).

use crate::likelihood::misfit;
use crate::normal::QUANTILE;
use crate::optimiser::LeastSquares;
use nalgebra::{DMatrix, DVector};

/// A bound is moved out by at most this factor. With a flatter likelihood the parameter is not identifiable.
const FLATTEST: f64 = 10.0;
/// A parameter is identifiable where its interval is shorter than this share of its search range.
const IDENTIFIABLE: f64 = 0.5;

/// How closely a fit determines its parameters, in their coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Information {
    /// 95 % interval of each parameter.
    pub intervals: Vec<[f64; 2]>,
    /// Correlation between each pair: a row and a column per parameter, in their order.
    pub correlations: DMatrix<f64>,
    /// The least identifiable parameter, if its interval is no narrower than half of its range.
    pub unidentifiable: Option<usize>,
}

/// The information at the best fit `x`, one coordinate per parameter; two evaluations of the model per parameter.
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
    Information {
        unidentifiable: unidentifiable(&intervals, &bounds),
        correlations: DMatrix::from_fn(count, count, |i, j| {
            covariance[(i, j)] / (deviation(i) * deviation(j))
        }),
        intervals,
    }
}

/// The information of a covariance at the best fit `x`.
pub(crate) fn intervals_of(
    x: &[f64],
    bounds: &[[f64; 2]],
    covariance: &DMatrix<f64>,
) -> Information {
    let deviation = |i: usize| covariance[(i, i)].sqrt();
    let around = |(i, x): (usize, &f64)| [-1.0, 1.0].map(|sign| x + sign * QUANTILE * deviation(i));
    let intervals: Vec<[f64; 2]> = x.iter().enumerate().map(around).collect();
    Information {
        unidentifiable: unidentifiable(&intervals, bounds),
        correlations: DMatrix::from_fn(x.len(), x.len(), |i, j| match i == j {
            true => 1.0,
            false => covariance[(i, j)] / (deviation(i) * deviation(j)),
        }),
        intervals,
    }
}

/// The parameter whose interval is the greatest share of its range, where that is half or more.
fn unidentifiable(intervals: &[[f64; 2]], bounds: &[[f64; 2]]) -> Option<usize> {
    let share = |i: usize| share(&intervals[i], &bounds[i]);
    (0..intervals.len())
        .max_by(|a, b| share(*a).total_cmp(&share(*b)))
        .filter(|i| !is_identifiable(&intervals[*i], &bounds[*i]))
}

/// Whether an interval is short enough beside its range.
pub(crate) fn is_identifiable(interval: &[f64; 2], bounds: &[f64; 2]) -> bool {
    share(interval, bounds) < IDENTIFIABLE
}

/// An interval as a share of its range.
fn share([low, high]: &[f64; 2], bounds: &[f64; 2]) -> f64 {
    let share = (high - low) / (bounds[1] - bounds[0]);
    if share.is_finite() {
        share
    } else {
        f64::INFINITY
    }
}

impl Information {
    /// That of the parameters of these indices alone.
    pub(crate) fn subset(&self, keep: &[usize]) -> Self {
        Self {
            intervals: keep.iter().map(|i| self.intervals[*i]).collect(),
            correlations: self.correlations.select_rows(keep).select_columns(keep),
            unidentifiable: None,
        }
    }

    /// The same with intervals about `x` that are wider by these factors, one per parameter.
    pub fn widened(mut self, factors: &[f64], x: &[f64]) -> Self {
        for ((interval, factor), x) in self.intervals.iter_mut().zip(factors).zip(x) {
            *interval = interval.map(|end| x + factor * (end - x));
        }
        self
    }
}

/// By how much the intervals of the parameters `known` are wider than [`information`] says, which
/// takes the others for known and the model for right. `problem` has all parameters free.
///
/// - A parameter that is not identifiable may lie anywhere within its bounds, and what can imitate it moves along.
/// - Where more than noise is left, it counts most in the residuals that a parameter follows. The sandwich
///   H⁻¹ (Σ r² j jᵀ) H⁻¹ is the covariance of a fit whose model is wrong (Huber 1967, White 1982).
pub fn widening(problem: &impl LeastSquares, x: &[f64], known: &[usize]) -> Vec<f64> {
    if known.is_empty() {
        return Vec::new();
    }
    let residuals = problem.residuals(x);
    let jacobian = problem.jacobian(x);
    let excess = misfit(&residuals).max(1.0).powi(2);
    let information = jacobian.transpose() * &jacobian / excess;
    let mut weighted = jacobian.clone();
    for (mut row, residual) in weighted.row_iter_mut().zip(&residuals) {
        row *= *residual / excess;
    }
    let spread = weighted.transpose() * &weighted;
    // Evenly spread over a width w, a value has the variance w²/12.
    let bounds = problem.bounds();
    let prior = DVector::from_fn(x.len(), |i, _| match known.contains(&i) {
        true => 0.0,
        false => 12.0 / (bounds[i][1] - bounds[i][0]).powi(2),
    });
    let prior = DMatrix::from_diagonal(&prior);
    let of_all = inverse(&information + &prior);
    let sandwich = &of_all * (spread + prior) * &of_all;
    let of_known = DMatrix::from_fn(known.len(), known.len(), |i, j| {
        information[(known[i], known[j])]
    });
    let of_known = inverse(of_known);
    known
        .iter()
        .enumerate()
        .map(|(place, i)| {
            let variance = of_all[(*i, *i)].max(sandwich[(*i, *i)]);
            (variance / of_known[(place, place)]).sqrt().max(1.0)
        })
        .collect()
}

/// (JᵀJ)⁻¹. A direction that the residuals do not feel gets a variance that is as good as infinite.
fn covariance(jacobian: &DMatrix<f64>) -> DMatrix<f64> {
    inverse(jacobian.transpose() * jacobian)
}

fn inverse(information: DMatrix<f64>) -> DMatrix<f64> {
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
        let information = information(&Line, &[0.94, 0.04, 0.0]);
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
        assert_eq!(information.unidentifiable, Some(2));
    }

    /// A line whose slope is known to lie within 2 only.
    struct Slope;

    impl LeastSquares for Slope {
        fn bounds(&self) -> Vec<[f64; 2]> {
            vec![[-10.0, 10.0], [-1.0, 1.0]]
        }
        fn count(&self) -> usize {
            Line.count()
        }
        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            Line.residuals(&[x[0], x[1], 0.0])
        }
        fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
            Line.jacobian(x).columns(0, 2).into_owned()
        }
    }

    #[test]
    fn an_unidentifiable_parameter_widens_what_can_imitate_it() {
        // Of four points the intercept has the variance 1/4 with a known slope. One that is spread
        // evenly over a width of 2 has 1/3: the information is [[4, 6], [6, 14 + 3]].
        let factors = widening(&Slope, &[0.97, 0.02], &[0]);
        let expected = (17.0_f64 / (4.0 * 17.0 - 36.0) / 0.25).sqrt();
        assert!((factors[0] / expected - 1.0).abs() < 1e-9, "{factors:?}");
        assert_eq!(widening(&Slope, &[0.97, 0.02], &[0, 1]), [1.0, 1.0]);
    }

    /// A constant through a step of height 2: the residuals are ±1.
    struct Step {
        scale: f64,
    }

    impl LeastSquares for Step {
        fn bounds(&self) -> Vec<[f64; 2]> {
            vec![[-10.0, 10.0]]
        }
        fn count(&self) -> usize {
            4
        }
        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            // The parameter is felt by the two great residuals alone.
            vec![self.scale + x[0], -self.scale + x[0], 0.1, -0.1]
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::from_column_slice(4, 1, &[1.0, 1.0, 0.0, 0.0])
        }
    }

    #[test]
    fn a_wrong_model_widens_what_its_errors_pull_at() {
        // Spread Σ r² j² = 2 s², information 2: variance s²/2; the misfit squared is nearly s²/2,
        // and gives s²/4.
        let factors = widening(&Step { scale: 10.0 }, &[0.0], &[0]);
        assert!((factors[0] - 2.0_f64.sqrt()).abs() < 1e-3, "{factors:?}");
        // Where nothing is identifiable there is nothing to widen.
        assert!(widening(&Step { scale: 10.0 }, &[0.0], &[]).is_empty());
    }
}
