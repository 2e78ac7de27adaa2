//! Levenberg and Marquardt's method with derivatives that are carried from step to step.
//!
//! The derivatives of a motion cost several times what the motion itself does. They are taken once, and corrected after
//! each step by what it has shown (Broyden 1965). They are taken anew where the corrected ones lead no further (the
//! secant version of the method, Madsen, Nielsen and Tingleff 2004, section 3.5).

use crate::optimiser::{LeastSquares, Progress, Watch, derivatives};
use nalgebra::{DMatrix, DVector};

/// Damping to begin with, over the greatest element of the normal matrix.
const DAMPING: f64 = 1e-3;
/// Damping beyond which no step is left.
const NO_STEP: f64 = 1e12;
/// Steps that may fail with corrected derivatives before they are taken anew.
const FAILURES: usize = 2;

/// The best point within bounds that a descent from `start` leads to. Ends where a step no longer changes the sum of
/// squares by the share `change`, or after `most` evaluations; one with derivatives counts as [`derivatives`] says.
pub fn secant(
    problem: &impl LeastSquares,
    start: &[f64],
    change: f64,
    most: u64,
    watch: Watch,
) -> Progress {
    let bounds = problem.bounds();
    let each = derivatives(start.len());
    let mut descent = Descent::at(problem, start);
    let mut evaluations = 1 + each;
    let mut damping = DAMPING * descent.normal().diagonal().max();
    let (mut fresh, mut failures, mut growth) = (true, 0, 2.0);
    loop {
        let progress = descent.progress(problem.count(), evaluations);
        let stopped = watch(&progress).is_break();
        if stopped || evaluations >= most || !damping.is_finite() || damping > NO_STEP {
            return progress;
        }
        let Some((x, predicted)) = descent.step(damping, &bounds) else {
            return progress;
        };
        let residuals = DVector::from_vec(problem.residuals(x.as_slice()));
        evaluations += 1;
        let cost = descent.cost();
        let gained = cost - 0.5 * residuals.norm_squared();
        descent.correct(&x, &residuals);
        let was_fresh = fresh;
        let mut ends = false;
        if gained > 0.0 {
            ends = gained < change * cost;
            (descent.x, descent.residuals) = (x, residuals);
            let quality = gained / predicted.max(f64::MIN_POSITIVE);
            damping *= (1.0 - (2.0 * quality - 1.0).powi(3)).clamp(1.0 / 3.0, 2.0);
            (growth, failures, fresh) = (2.0, 0, false);
        } else {
            damping *= growth;
            growth *= 2.0;
            failures += 1;
        }
        // A step that changes little ends the descent where its derivatives were no corrected ones.
        if ends && was_fresh {
            return descent.progress(problem.count(), evaluations);
        }
        if (ends || failures >= FAILURES) && !fresh {
            if evaluations + each >= most {
                return descent.progress(problem.count(), evaluations);
            }
            descent.jacobian = problem.jacobian(descent.x.as_slice());
            evaluations += each;
            (fresh, failures, growth) = (true, 0, 2.0);
        }
    }
}

/// Where a descent stands.
struct Descent {
    x: DVector<f64>,
    residuals: DVector<f64>,
    /// Derivatives: a row per residual, a column per coordinate.
    jacobian: DMatrix<f64>,
}

impl Descent {
    fn at(problem: &impl LeastSquares, x: &[f64]) -> Self {
        Self {
            x: DVector::from_column_slice(x),
            residuals: DVector::from_vec(problem.residuals(x)),
            jacobian: problem.jacobian(x),
        }
    }

    /// Half the sum of squares.
    fn cost(&self) -> f64 {
        0.5 * self.residuals.norm_squared()
    }

    fn progress(&self, count: usize, evaluations: u64) -> Progress {
        Progress {
            x: self.x.as_slice().to_vec(),
            cost: self.cost(),
            count,
            evaluations,
        }
    }

    fn normal(&self) -> DMatrix<f64> {
        self.jacobian.tr_mul(&self.jacobian)
    }

    /// The next point with this damping, and by how much it should lower the cost. Coordinates at a bound that the
    /// descent would leave are held. None where nothing moves.
    fn step(&self, damping: f64, bounds: &[[f64; 2]]) -> Option<(DVector<f64>, f64)> {
        let gradient = self.jacobian.tr_mul(&self.residuals);
        let held = |i: usize| {
            let [low, high] = bounds[i];
            (self.x[i] <= low && gradient[i] > 0.0) || (self.x[i] >= high && gradient[i] < 0.0)
        };
        let mut normal = self.normal();
        let mut downhill = -&gradient;
        for i in 0..self.x.len() {
            if held(i) {
                normal.row_mut(i).fill(0.0);
                normal.column_mut(i).fill(0.0);
                downhill[i] = 0.0;
            }
            normal[(i, i)] += damping;
        }
        let step = normal.cholesky()?.solve(&downhill);
        let mut x = &self.x + step;
        for (x, [low, high]) in x.iter_mut().zip(bounds) {
            *x = x.clamp(*low, *high);
        }
        let moved = &x - &self.x;
        let linear = &self.residuals + &self.jacobian * &moved;
        let predicted = 0.5 * (self.residuals.norm_squared() - linear.norm_squared());
        (moved.norm_squared() > 0.0).then_some((x, predicted))
    }

    /// Corrects the derivatives by what a step to `x` has shown.
    fn correct(&mut self, x: &DVector<f64>, residuals: &DVector<f64>) {
        let moved = x - &self.x;
        let error = residuals - &self.residuals - &self.jacobian * &moved;
        let size = moved.norm_squared();
        self.jacobian.ger(1.0 / size, &error, &moved, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimiser::valley::Valley;
    use std::ops::ControlFlow;

    #[test]
    fn it_finds_the_bottom_of_the_valley() {
        let go = &mut |_: &Progress| ControlFlow::Continue(());
        let found = secant(&Valley, &[-1.2, 1.0], 1e-9, 500, go);
        assert!(found.cost < 1e-8, "{found:?}");
    }

    #[test]
    fn it_stays_within_bounds() {
        struct Beyond;
        impl LeastSquares for Beyond {
            fn bounds(&self) -> Vec<[f64; 2]> {
                vec![[0.0, 1.0], [0.0, 5.0]]
            }
            fn count(&self) -> usize {
                2
            }
            fn residuals(&self, x: &[f64]) -> Vec<f64> {
                vec![x[0] - 2.0, x[1] - 3.0]
            }
            fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
                DMatrix::identity(2, 2)
            }
        }
        let go = &mut |_: &Progress| ControlFlow::Continue(());
        let found = secant(&Beyond, &[0.5, 0.5], 1e-9, 200, go);
        assert!(
            (found.x[0] - 1.0).abs() < 1e-12 && (found.x[1] - 3.0).abs() < 1e-6,
            "{found:?}"
        );
    }
}
