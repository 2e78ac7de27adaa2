//! The optimisers, from the crate `basin`: Levenberg and Marquardt's method, CMA-ES, a genetic
//! algorithm.

use crate::error::Error;
use basin::{
    BoundedCmaEs, BoundedLevenbergMarquardt, BoxBounds, ConstraintSet, Constraints, CostFunction,
    DenseMatrix, Executor, Jacobian, PointState, PopulationProgress, Residual, Ssga, StepOutcome,
};
use nalgebra::DMatrix;
use std::cell::RefCell;
use std::ops::ControlFlow;

/// A sum of squares to be made small within bounds.
pub trait LeastSquares {
    /// Least and greatest value of each coordinate.
    fn bounds(&self) -> Vec<[f64; 2]>;
    /// How many residuals there are.
    fn count(&self) -> usize;
    /// The residuals at `x`.
    fn residuals(&self, x: &[f64]) -> Vec<f64>;
    /// The residuals at each of these points.
    fn residuals_of_all(&self, all: &[Vec<f64>]) -> Vec<Vec<f64>> {
        all.iter().map(|x| self.residuals(x)).collect()
    }
    /// Points that have some coordinates of one of `all` and some of another one, and whose sum of squares is least, from so many of
    /// the first ones; with that sum. None where what coordinates add to the residuals cannot be taken apart.
    fn mixed(&self, _all: &[Vec<f64>], _first: usize) -> Vec<(Vec<f64>, f64)> {
        Vec::new()
    }
    /// Their derivatives: a row per residual, a column per coordinate.
    fn jacobian(&self, x: &[f64]) -> DMatrix<f64>;
}

/// Where an optimiser stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// The best point so far.
    pub x: Vec<f64>,
    /// Half the sum of squares there.
    pub cost: f64,
    /// Residuals that it is the sum of.
    pub count: usize,
    /// Evaluations of the model so far; one with derivatives counts as [`derivatives`] says.
    pub evaluations: u64,
}

impl Progress {
    /// Root mean square of the residuals.
    pub fn misfit(&self) -> f64 {
        (2.0 * self.cost / self.count.max(1) as f64).sqrt()
    }
}

/// How many plain evaluations one with the derivatives by so many parameters counts for. Tangents are
/// carried through one revolution of a motion that has settled, and not through the transient. Two
/// clear joints take 2.1, 2.8, 2.8 and 2.8 times the plain steps with 3, 6, 8 and 12 parameters
/// (`tests/all/cost.rs`).
pub fn derivatives(parameters: usize) -> u64 {
    2 + parameters as u64 / 12
}

/// Told after each evaluation of the model; stops the search where it says so.
pub type Watch<'a> = &'a mut dyn FnMut(&Progress) -> ControlFlow<()>;

/// The search was stopped by its watch, or has made the evaluations that it was given.
#[derive(Debug, thiserror::Error)]
#[error("stopped")]
struct Stopped;

/// What a search has seen so far.
struct Seen<'w> {
    best: Progress,
    most: u64,
    watch: Watch<'w>,
    stopped: bool,
}

impl Seen<'_> {
    /// Takes note of evaluations, the cost at `x` among them where it was asked for.
    fn note(&mut self, evaluations: u64, x: &[f64], cost: Option<f64>) -> Result<(), Stopped> {
        self.best.evaluations += evaluations;
        if let Some(cost) = cost.filter(|cost| *cost < self.best.cost) {
            self.best.cost = cost;
            self.best.x = x.to_vec();
        }
        let stop = (self.watch)(&self.best).is_break();
        self.stopped |= stop || self.best.evaluations >= self.most;
        if self.stopped { Err(Stopped) } else { Ok(()) }
    }
}

/// An optimisation problem as the crate sees it, which notes its evaluations.
struct Noted<'a, 'w, T> {
    inner: &'a T,
    low: Vec<f64>,
    high: Vec<f64>,
    seen: &'a RefCell<Seen<'w>>,
}

impl<'a, 'w, T: LeastSquares> Noted<'a, 'w, T> {
    fn new(inner: &'a T, seen: &'a RefCell<Seen<'w>>) -> Self {
        let (low, high) = inner.bounds().iter().map(|b| (b[0], b[1])).unzip();
        Self {
            inner,
            low,
            high,
            seen,
        }
    }

    /// The residuals at `x` and half the sum of their squares.
    fn evaluate(&self, x: &[f64]) -> Result<(Vec<f64>, f64), Stopped> {
        let residuals = self.inner.residuals(x);
        let cost = 0.5 * residuals.iter().map(|r| r * r).sum::<f64>();
        self.seen.borrow_mut().note(1, x, Some(cost))?;
        Ok((residuals, cost))
    }
}

impl<T: LeastSquares> Constraints for Noted<'_, '_, T> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;
    fn constraints(&self) -> <Self::Set as basin::ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.low), Some(&self.high)))
    }
}

impl<T: LeastSquares> CostFunction for Noted<'_, '_, T> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Stopped;
    fn cost(&self, x: &Vec<f64>) -> Result<f64, Stopped> {
        Ok(self.evaluate(x)?.1)
    }
}

impl<T: LeastSquares> Residual for Noted<'_, '_, T> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Error = Stopped;
    fn residual(&self, x: &Vec<f64>) -> Result<Vec<f64>, Stopped> {
        Ok(self.evaluate(x)?.0)
    }
}

impl<T: LeastSquares> Jacobian for Noted<'_, '_, T> {
    type Jacobian = DenseMatrix;
    fn jacobian(&self, x: &Vec<f64>) -> Result<DenseMatrix, Stopped> {
        let jacobian = self.inner.jacobian(x);
        let evaluations = derivatives(self.low.len());
        self.seen.borrow_mut().note(evaluations, x, None)?;
        Ok(DenseMatrix::from_fn(
            jacobian.nrows(),
            jacobian.ncols(),
            |i, j| jacobian[(i, j)],
        ))
    }
}

/// The best that `run` sees until it ends or is stopped; `start` stands for it before the first
/// evaluation.
fn search<T: LeastSquares>(
    problem: &T,
    start: &[f64],
    most: u64,
    watch: Watch,
    run: impl FnOnce(Noted<'_, '_, T>) -> Result<(), String>,
) -> Result<Progress, Error> {
    let seen = RefCell::new(Seen {
        best: Progress {
            x: start.to_vec(),
            cost: f64::INFINITY,
            count: problem.count(),
            evaluations: 0,
        },
        most,
        watch,
        stopped: false,
    });
    let ended = run(Noted::new(problem, &seen));
    let seen = seen.into_inner();
    match ended {
        Err(error) if !seen.stopped => Err(Error::Optimiser(error)),
        _ => Ok(seen.best),
    }
}

/// Steps of an executor until it ends.
macro_rules! to_its_end {
    ($executor:expr) => {{
        let mut stepper = $executor.into_stepper().map_err(|e| e.to_string())?;
        while !matches!(
            stepper.step().map_err(|e| e.to_string())?,
            StepOutcome::Stopped(_)
        ) {}
        Ok(())
    }};
}

/// Levenberg and Marquardt's method within bounds (Levenberg 1944, Marquardt 1963; bounds after
/// Branch, Coleman and Li 1999), from `start`. Ends where a step no longer changes the sum of
/// squares by the share `change`.
///
/// # Errors
/// An optimiser that cannot start or go on. A search that `watch` stops is no error: its best point is the result.
pub fn levenberg_marquardt(
    problem: &impl LeastSquares,
    start: &[f64],
    change: f64,
    most: u64,
    watch: Watch,
) -> Result<Progress, Error> {
    let solver = BoundedLevenbergMarquardt::<Vec<f64>, DenseMatrix>::new()
        .with_relative_cost_change_tolerance(change);
    search(problem, start, most, watch, |problem| {
        let state = PointState::new(start.to_vec());
        to_its_end!(Executor::new(problem, solver, state))
    })
}

/// CMA-ES within bounds (Hansen 2016), from `start`, with an initial standard deviation of a
/// quarter of the widths of the bounds.
///
/// # Errors
/// As [`levenberg_marquardt`].
pub fn cma_es(
    problem: &impl LeastSquares,
    start: &[f64],
    seed: u64,
    most: u64,
    watch: Watch,
) -> Result<Progress, Error> {
    let widths = problem
        .bounds()
        .iter()
        .map(|b| b[1] - b[0])
        .collect::<Vec<_>>();
    let solver = BoundedCmaEs::<Vec<f64>, DenseMatrix>::new(seed, 0.25)
        .with_stds(widths)
        .with_absolute_distribution_size_tolerance(1e-4);
    search(problem, start, most, watch, |problem| {
        let state = PopulationProgress::from_point(start.to_vec());
        to_its_end!(Executor::new(problem, solver, state))
    })
}

/// A genetic algorithm, the reference method (Paper 1). It is a steady-state one with real genes, blend
/// crossover and bounded mutation (Molina, Lozano, García-Martínez and Herrera 2010, section 4.4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Genetic {
    /// Individuals.
    pub population: usize,
    /// How far a child may lie outside its parents (BLX-α).
    pub crossover: f64,
    /// Probability that a gene mutates.
    pub mutation: f64,
}

impl Default for Genetic {
    fn default() -> Self {
        Self {
            population: 60,
            crossover: 0.5,
            mutation: 0.125,
        }
    }
}

/// The genetic algorithm within bounds.
///
/// # Errors
/// As [`levenberg_marquardt`].
pub fn genetic(
    problem: &impl LeastSquares,
    settings: &Genetic,
    seed: u64,
    most: u64,
    watch: Watch,
) -> Result<Progress, Error> {
    let solver = Ssga::new(seed)
        .with_pop_size(settings.population)
        .with_blx_alpha(settings.crossover)
        .with_mutation_prob(settings.mutation);
    let bounds = problem.bounds();
    let middle: Vec<f64> = bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect();
    search(problem, &middle, most, watch, |problem| {
        to_its_end!(Executor::new(problem, solver, PopulationProgress::empty()))
    })
}

#[cfg(test)]
pub(crate) mod valley {
    use super::*;

    /// Rosenbrock's valley as a sum of squares.
    pub(crate) struct Valley;

    impl LeastSquares for Valley {
        fn bounds(&self) -> Vec<[f64; 2]> {
            vec![[-2.0, 3.0]; 2]
        }
        fn count(&self) -> usize {
            2
        }
        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]
        }
        fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
            DMatrix::from_row_slice(2, 2, &[-20.0 * x[0], 10.0, -1.0, 0.0])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::valley::Valley;
    use super::*;

    fn go(_: &Progress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn at_the_bottom(found: &Progress, within: f64) {
        for x in &found.x {
            assert!((x - 1.0).abs() < within, "{found:?}");
        }
    }

    #[test]
    fn each_finds_the_bottom_of_the_valley() {
        let found = levenberg_marquardt(&Valley, &[-1.2, 1.0], 1e-6, 1000, &mut go).unwrap();
        at_the_bottom(&found, 1e-4);
        assert!(found.evaluations < 300, "{found:?}");
        at_the_bottom(
            &cma_es(&Valley, &[-1.2, 1.0], 1, 5000, &mut go).unwrap(),
            1e-2,
        );
        at_the_bottom(
            &genetic(&Valley, &Genetic::default(), 1, 20_000, &mut go).unwrap(),
            1e-1,
        );
    }

    #[test]
    fn a_watch_stops_and_a_seed_repeats() {
        let mut calls = 0;
        let found = cma_es(&Valley, &[0.0, 0.0], 7, 5000, &mut |_| {
            calls += 1;
            if calls < 5 {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        })
        .unwrap();
        assert_eq!(calls, 5);
        let run = |seed| cma_es(&Valley, &[0.0, 0.0], seed, 300, &mut go).unwrap();
        assert_eq!(run(3), run(3));
        assert_ne!(run(3), run(4));
        assert!(found.cost.is_finite());
    }

    #[test]
    fn no_more_is_evaluated_than_allowed() {
        let found = genetic(&Valley, &Genetic::default(), 1, 200, &mut go).unwrap();
        assert!(found.evaluations <= 202, "{found:?}");
    }
}
