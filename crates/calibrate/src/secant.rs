//! Levenberg and Marquardt's method with derivatives that are carried from step to step.
//!
//! The derivatives of a motion cost several times what the motion itself does. They are taken once, and corrected after
//! each step by what it has shown (Broyden 1965). They are taken anew where the corrected ones lead no further (the
//! secant version of the method, Madsen, Nielsen and Tingleff 2004, section 3.5).

use crate::optimiser::{LeastSquares, Progress, Watch, derivatives};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

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
    let limits = Limits { change, most };
    let residuals = problem.residuals(start);
    let mut walk = Walk::new(start, residuals, problem.jacobian(start), limits);
    loop {
        let progress = walk.progress(problem.count());
        if watch(&progress).is_break() {
            return progress;
        }
        let Some(step) = walk.step(&bounds) else {
            return progress;
        };
        let residuals = problem.residuals(step.x.as_slice());
        match walk.take(step, residuals) {
            Next::Step => {}
            Next::Derivatives => walk.renew(problem.jacobian(walk.descent.x.as_slice())),
            Next::End => return walk.progress(problem.count()),
        }
    }
}

/// The same from each of several starts. What they ask for at the same time is evaluated together; none depends on another.
pub(crate) fn secants(
    problem: &(impl LeastSquares + Sync),
    starts: &[Vec<f64>],
    change: f64,
    most: u64,
) -> Vec<Progress> {
    let bounds = problem.bounds();
    let limits = Limits { change, most };
    let begun = starts.iter().zip(problem.residuals_of_all(starts));
    let begun: Vec<(&Vec<f64>, Vec<f64>)> = begun.collect();
    let new = |(start, residuals): (&Vec<f64>, Vec<f64>)| {
        Walk::new(start, residuals, problem.jacobian(start), limits)
    };
    let mut walks: Vec<Walk> = begun.into_par_iter().map(new).collect();
    let mut going: Vec<&mut Walk> = walks.iter_mut().collect();
    while !going.is_empty() {
        let steps = going.into_iter().filter_map(|walk| {
            let step = walk.step(&bounds)?;
            Some((walk, step))
        });
        let steps: Vec<(&mut Walk, Step)> = steps.collect();
        let points = steps.iter().map(|(_, step)| step.x.as_slice().to_vec());
        let residuals = problem.residuals_of_all(&points.collect::<Vec<_>>());
        let taken = steps.into_par_iter().zip(residuals);
        let next = taken.filter_map(|((walk, step), residuals)| {
            match walk.take(step, residuals) {
                Next::Step => {}
                Next::Derivatives => walk.renew(problem.jacobian(walk.descent.x.as_slice())),
                Next::End => return None,
            }
            Some(walk)
        });
        going = next.collect();
    }
    let count = problem.count();
    walks.iter().map(|walk| walk.progress(count)).collect()
}

/// Where a descent ends.
#[derive(Clone, Copy)]
struct Limits {
    /// Relative change of the sum of squares.
    change: f64,
    /// Evaluations.
    most: u64,
}

/// A descent under way.
struct Walk {
    descent: Descent,
    limits: Limits,
    evaluations: u64,
    damping: f64,
    /// Factor of the damping after the next step that fails.
    growth: f64,
    /// Whether the derivatives are those of the point itself.
    fresh: bool,
    /// Steps in a row that have failed.
    failures: usize,
}

/// A step that is to be evaluated.
struct Step {
    x: DVector<f64>,
    /// By how much it should lower the cost.
    predicted: f64,
}

/// What a descent needs next.
enum Next {
    Step,
    Derivatives,
    End,
}

impl Walk {
    fn new(start: &[f64], residuals: Vec<f64>, jacobian: DMatrix<f64>, limits: Limits) -> Self {
        let descent = Descent {
            x: DVector::from_column_slice(start),
            residuals: DVector::from_vec(residuals),
            jacobian,
        };
        Self {
            damping: DAMPING * descent.normal().diagonal().max(),
            descent,
            limits,
            evaluations: 1 + derivatives(start.len()),
            growth: 2.0,
            fresh: true,
            failures: 0,
        }
    }

    fn progress(&self, count: usize) -> Progress {
        Progress {
            x: self.descent.x.as_slice().to_vec(),
            cost: self.descent.cost(),
            count,
            evaluations: self.evaluations,
        }
    }

    /// The next step; none where the descent ends.
    fn step(&self, bounds: &[[f64; 2]]) -> Option<Step> {
        let is_spent = self.evaluations >= self.limits.most;
        if is_spent || !self.damping.is_finite() || self.damping > NO_STEP {
            return None;
        }
        let (x, predicted) = self.descent.step(self.damping, bounds)?;
        Some(Step { x, predicted })
    }

    /// Takes a step, where it leads down, and learns from it.
    fn take(&mut self, step: Step, residuals: Vec<f64>) -> Next {
        let residuals = DVector::from_vec(residuals);
        self.evaluations += 1;
        let cost = self.descent.cost();
        let gained = cost - 0.5 * residuals.norm_squared();
        self.descent.correct(&step.x, &residuals);
        let was_fresh = self.fresh;
        let mut ends = false;
        if gained > 0.0 {
            ends = gained < self.limits.change * cost;
            (self.descent.x, self.descent.residuals) = (step.x, residuals);
            let quality = gained / step.predicted.max(f64::MIN_POSITIVE);
            self.damping *= (1.0 - (2.0 * quality - 1.0).powi(3)).clamp(1.0 / 3.0, 2.0);
            (self.growth, self.failures, self.fresh) = (2.0, 0, false);
        } else {
            self.damping *= self.growth;
            self.growth *= 2.0;
            self.failures += 1;
        }
        // A step that changes little ends the descent where its derivatives were no corrected ones.
        if ends && was_fresh {
            return Next::End;
        }
        if !(ends || self.failures >= FAILURES) || self.fresh {
            return Next::Step;
        }
        match self.evaluations + derivatives(self.descent.x.len()) >= self.limits.most {
            true => Next::End,
            false => Next::Derivatives,
        }
    }

    /// Goes on with these derivatives of the point itself.
    fn renew(&mut self, jacobian: DMatrix<f64>) {
        self.descent.jacobian = jacobian;
        self.evaluations += derivatives(self.descent.x.len());
        (self.fresh, self.failures, self.growth) = (true, 0, 2.0);
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
    /// Half the sum of squares.
    fn cost(&self) -> f64 {
        0.5 * self.residuals.norm_squared()
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
    fn several_descents_lead_where_each_leads_by_itself() {
        let starts = [vec![-1.2, 1.0], vec![0.3, -0.7], vec![2.0, 2.0]];
        for most in [5, 30, 500] {
            let go = &mut |_: &Progress| ControlFlow::Continue(());
            let mut alone = |start: &Vec<f64>| secant(&Valley, start, 1e-9, most, go);
            let alone: Vec<Progress> = starts.iter().map(&mut alone).collect();
            assert_eq!(secants(&Valley, &starts, 1e-9, most), alone);
        }
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
