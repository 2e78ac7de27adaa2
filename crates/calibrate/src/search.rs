//! The default search: descents that begin with the low orders, from several points.
//!
//! The high orders of an acceleration are the ringing of the contacts. Their phases turn several
//! times within the bounds of a stiffness, so that the sum of squares has many local minima; the
//! low orders have few. A descent therefore allows at first that features stand at other crank
//! angles, which leaves the low orders only. It then allows less and less of that, each time from where the
//! last descent ended. This is a continuation from low frequencies, as in the inversion of seismic waves (Bunks,
//! Saleck, Zaleski and Chavent 1995).

use crate::envelopes::Envelopes;
use crate::error::Error;
use crate::halves::halves;
use crate::likelihood::NOISE;
use crate::likelihood::{Likelihood, misfit};
use crate::optimiser::{self, LeastSquares, Progress, Watch};
use crate::problem::Problem;
use crate::throw_alone::{ThrowAlone, throws_alone};
use rand::RngExt;
use scalar::random::{Purpose, stream};
use std::ops::ControlFlow;

/// For a throw by itself this is near enough: what the encoder does not show of the crank's turning
/// is left over.
const NEAR: f64 = 2.0;
/// By how much features may stand elsewhere in the steps of a descent, rad, before they must stand
/// where they are seen.
const TIMINGS: [f64; 4] = [0.1, 0.03, 0.01, 0.003];
/// Points per parameter that are looked at with the coarsest timing, and the best of them from which
/// the search descends.
const POINTS_PER_PARAMETER: usize = 4;
pub(crate) const STARTS: usize = 8;
/// By how much a coordinate is moved out of a local minimum: a third of a value, about as much as
/// design values are wrong.
const KICK: f64 = 0.3;
/// How many of the kicks are followed.
const KICKS: usize = 4;
/// By how much features may stand elsewhere in a rough descent, rad.
pub const LOOSE: f64 = 0.01;
/// Step of the logarithm of a clearance on the grid. The time in which a gap is crossed goes with its root. It
/// changes by 7 %, some hundredths of a radian of the crank, less than [`TIMINGS`] allow at first.
const CLEARANCE_STEP: f64 = 0.15;
/// Descents that end at the same misfit, to this share, have found the least one.
const SAME: f64 = 0.01;
const AGREE: usize = 3;
/// Evaluations per parameter that CMA-ES is given.
const GLOBAL: u64 = 100;

/// Relative change of the sum of squares at which a descent ends, and a coarse one.
pub(crate) const CHANGE: f64 = 1e-6;
const COARSE_CHANGE: f64 = 1e-2;

/// A search under way.
struct Search<'a, 'w> {
    problem: &'a Problem,
    most: u64,
    spent: u64,
    stopped: bool,
    best: Progress,
    /// The misfit that is looked for.
    wanted: f64,
    /// Misfits in which descents have ended.
    minima: Vec<f64>,
    watch: Watch<'w>,
}

/// The best fit, by Levenberg and Marquardt's method.
///
/// 1. From `start`, each of several throws by itself at first.
/// 2. Where that leaves more than noise: by parts of the runs, with continuation, from kicks out of where that ends,
///    and from the best of many other points. This ends when the noise is reached or [`AGREE`] descents have ended
///    at the same misfit.
/// 3. Where they do not agree: by CMA-ES.
///
/// # Errors
/// Where an optimiser cannot start.
pub(crate) fn search(
    problem: &Problem,
    start: &[f64],
    seed: u64,
    most: u64,
    watch: Watch,
) -> Result<Progress, Error> {
    let mut search = Search::new(problem, start, most, NOISE, watch);
    let start = search.begin(start, seed)?;
    search.locally(&start)?;
    search.elsewhere(&start, seed)?;
    if !search.ended() {
        search.globally(seed)?;
    }
    Ok(search.into_best())
}

/// What [`search`] begins with, up to the end of its first descent.
///
/// # Errors
/// Where an optimiser cannot start.
pub(crate) fn first_descent(
    problem: &Problem,
    start: &[f64],
    seed: u64,
    most: u64,
    watch: Watch,
) -> Result<Progress, Error> {
    let mut search = Search::new(problem, start, most, NOISE, watch);
    let start = search.begin(start, seed)?;
    search.descend(None, &start)?;
    Ok(search.into_best())
}

impl<'a, 'w> Search<'a, 'w> {
    fn new(problem: &'a Problem, start: &[f64], most: u64, wanted: f64, watch: Watch<'w>) -> Self {
        let residuals = Likelihood::new(problem).residuals(start);
        Self {
            problem,
            most,
            spent: 1,
            stopped: false,
            best: Progress {
                x: start.to_vec(),
                cost: 0.5 * residuals.iter().map(|r| r * r).sum::<f64>(),
                count: residuals.len(),
                evaluations: 1,
            },
            wanted,
            minima: Vec::new(),
            watch,
        }
    }

    fn into_best(self) -> Progress {
        Progress {
            evaluations: self.spent,
            ..self.best
        }
    }

    fn left(&self) -> u64 {
        self.most.saturating_sub(self.spent)
    }

    fn ended(&self) -> bool {
        let best = self.best.misfit();
        let same = |misfit: &&f64| **misfit <= best * (1.0 + SAME);
        self.stopped
            || self.left() == 0
            || best < self.wanted
            || self.minima.iter().filter(same).count() >= AGREE
    }

    /// Where the first descent starts: several throws by themselves first, clearances on a grid.
    fn begin(&mut self, start: &[f64], seed: u64) -> Result<Vec<f64>, Error> {
        let throws = throws_alone(self.problem)?;
        match throws.is_empty() {
            true => Ok(self.at_clearances(start)),
            false => self.throw_by_throw(&throws, start, seed),
        }
    }

    /// From `start` each throw by itself, as far as that takes it. Each has an equal share of the evaluations, and so
    /// have all together: a throw in which something is missing would take all. Returns where it ends. A parameter that
    /// several throws share is then in the middle of their values.
    fn throw_by_throw(
        &mut self,
        throws: &[ThrowAlone],
        start: &[f64],
        seed: u64,
    ) -> Result<Vec<f64>, Error> {
        let mut found = vec![Vec::new(); start.len()];
        for (i, throw) in throws.iter().enumerate() {
            if self.stopped || self.left() == 0 {
                break;
            }
            let own: Vec<f64> = throw.parameters.iter().map(|i| start[*i]).collect();
            let left = self.left() / (throws.len() - i + 1) as u64;
            let alone = {
                let report = &mut self.reporter(false);
                let mut alone = Search::new(&throw.problem, &own, left, NEAR, report);
                let own = alone.at_clearances(&own);
                alone.locally(&own)?;
                alone.elsewhere(&own, seed)?;
                alone.into_best()
            };
            self.spent += alone.evaluations;
            for (i, x) in throw.parameters.iter().zip(alone.x) {
                found[*i].push(x);
            }
        }
        let middle = |(found, start): (&Vec<f64>, &f64)| match found.len() {
            0 => *start,
            count => found.iter().sum::<f64>() / count as f64,
        };
        Ok(found.iter().zip(start).map(middle).collect())
    }

    /// From `start` with each clearance that is fitted moved to the best of a grid. The time at which a clearance is
    /// crossed decides at which crank angle everything rings. A descent finds no way from one ringing to another.
    fn at_clearances(&mut self, start: &[f64]) -> Vec<f64> {
        let mut x = start.to_vec();
        let parameters = self.problem.parameters.iter().enumerate();
        let clearances = parameters.filter(|(_, parameter)| parameter.is_clearance());
        let clearances: Vec<usize> = clearances.map(|(i, _)| i).collect();
        let coarse = Likelihood::coarse(self.problem, TIMINGS[0]);
        let bounds = coarse.bounds();
        // Where one clearance is wrong, the best of another may be so too.
        let rounds = clearances.len().min(2);
        for i in std::iter::repeat_n(&clearances, rounds).flatten() {
            let points = grid(&x, *i, bounds[*i]);
            if let Some(best) = self.promising(&coarse, points, 1).pop() {
                x = best;
            }
        }
        x
    }

    /// From `start`, and out of the local minima on the way. Where the low orders agree with the
    /// recordings only the ringing is wrong, and a kick may do; elsewhere they come first.
    fn locally(&mut self, start: &[f64]) -> Result<(), Error> {
        self.descend(None, start)?;
        while !self.ended() && self.by_halves()? {}
        if self.ended() {
            return Ok(());
        }
        self.spent += 1;
        let loose = Likelihood::coarse(self.problem, LOOSE);
        if misfit(&loose.residuals(&self.best.x)) > NOISE {
            self.continuation(start)?;
        }
        while !self.ended() && self.kicked()? {}
        Ok(())
    }

    /// From the best of many points around `start`.
    fn elsewhere(&mut self, start: &[f64], seed: u64) -> Result<(), Error> {
        let coarse = Likelihood::coarse(self.problem, TIMINGS[0]);
        let spread = spread(start, &coarse.bounds(), seed);
        for start in self.promising(&coarse, spread, STARTS) {
            if self.ended() {
                break;
            }
            self.continuation(&start)?;
        }
        Ok(())
    }

    /// From the best point to parts of the runs by themselves, and from there to all; whether that has led to a
    /// better one.
    fn by_halves(&mut self) -> Result<bool, Error> {
        self.spent += 1;
        let (x, before, minima) = (self.best.x.clone(), self.best.cost, self.minima.len());
        for half in halves(self.problem, &x) {
            if self.ended() {
                break;
            }
            let left = self.left();
            let found = {
                let report = &mut self.reporter(false);
                optimiser::levenberg_marquardt(&Likelihood::new(&half), &x, CHANGE, left, report)?
            };
            self.spent += found.evaluations;
            if !self.ended() {
                self.descend(None, &found.x)?;
            }
            self.minima.truncate(minima);
            if self.best.cost < (1.0 - SAME) * before {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// From `start` with the low orders first.
    fn continuation(&mut self, start: &[f64]) -> Result<(), Error> {
        let mut x = self.ringing(start)?;
        for timing in TIMINGS.map(Some).into_iter().chain([None]) {
            if self.stopped || self.left() == 0 {
                break;
            }
            x = self.descend(timing, &x)?;
        }
        Ok(())
    }

    /// From the best point with one parameter moved; whether that has led to a better one. Descents
    /// that fall back say nothing about other minima.
    fn kicked(&mut self) -> Result<bool, Error> {
        let loose = Likelihood::coarse(self.problem, LOOSE);
        let kicked = kicks(&self.best.x, &loose.bounds());
        let (before, minima) = (self.best.cost, self.minima.len());
        for start in self.promising(&loose, kicked, KICKS) {
            if self.ended() {
                break;
            }
            let near = self.descend(Some(LOOSE), &start)?;
            if !self.ended() {
                self.descend(None, &near)?;
            }
            self.minima.truncate(minima);
            if self.best.cost < (1.0 - SAME) * before {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// From `start` to envelopes that agree. Where it ends.
    fn ringing(&mut self, start: &[f64]) -> Result<Vec<f64>, Error> {
        let envelopes = Envelopes::new(self.problem);
        let left = self.left();
        let found = {
            let report = &mut self.reporter(false);
            optimiser::levenberg_marquardt(&envelopes, start, COARSE_CHANGE, left, report)?
        };
        self.spent += found.evaluations;
        Ok(found.x)
    }

    /// From `start` with features that may stand elsewhere, or not. Where it ends.
    fn descend(&mut self, timing: Option<f64>, start: &[f64]) -> Result<Vec<f64>, Error> {
        let (likelihood, change) = match timing {
            Some(timing) => (Likelihood::coarse(self.problem, timing), COARSE_CHANGE),
            None => (Likelihood::new(self.problem), CHANGE),
        };
        let left = self.left();
        let found = {
            let mut report = self.reporter(timing.is_none());
            // What is left is then noise and timing, and less of that may be allowed.
            let mut watch = |progress: &Progress| match report(progress) {
                ControlFlow::Continue(()) if timing.is_some() && progress.misfit() < NOISE => {
                    ControlFlow::Break(())
                }
                answer => answer,
            };
            optimiser::levenberg_marquardt(&likelihood, start, change, left, &mut watch)?
        };
        self.spent += found.evaluations;
        let end = found.x.clone();
        if timing.is_none() {
            self.minima.push(found.misfit());
            self.better(found);
        }
        Ok(end)
    }

    /// CMA-ES from the best point so far, and a descent from where it ends.
    fn globally(&mut self, seed: u64) -> Result<(), Error> {
        let likelihood = Likelihood::new(self.problem);
        let x = self.best.x.clone();
        let most = self.left().min(GLOBAL * x.len() as u64);
        let found = {
            let report = &mut self.reporter(true);
            optimiser::cma_es(&likelihood, &x, seed, most, report)?
        };
        self.spent += found.evaluations;
        let end = found.x.clone();
        self.better(found);
        if !self.ended() {
            self.descend(None, &end)?;
        }
        Ok(())
    }

    fn better(&mut self, found: Progress) {
        if found.cost < self.best.cost {
            self.best = found;
        }
    }

    /// Tells the best so far with every step of an optimiser; with `same` its cost is the search's
    /// own and may be the best.
    fn reporter(&mut self, same: bool) -> impl FnMut(&Progress) -> ControlFlow<()> {
        move |progress| {
            let Self { best, spent, .. } = &*self;
            let better = same && progress.cost < best.cost;
            let report = Progress {
                evaluations: *spent + progress.evaluations,
                ..if better { progress } else { best }.clone()
            };
            let answer = (self.watch)(&report);
            self.stopped |= answer.is_break();
            answer
        }
    }

    /// The `count` best of these points; none once the search has ended.
    fn promising(
        &mut self,
        likelihood: &Likelihood,
        points: Vec<Vec<f64>>,
        count: usize,
    ) -> Vec<Vec<f64>> {
        let mut costs = Vec::new();
        if self.ended() {
            return Vec::new();
        }
        for point in points {
            let report = Progress {
                evaluations: self.spent,
                ..self.best.clone()
            };
            self.stopped |= (self.watch)(&report).is_break();
            if self.stopped || self.left() == 0 {
                break;
            }
            costs.push((misfit(&likelihood.residuals(&point)), point));
            self.spent += 1;
        }
        costs.sort_by(|a, b| a.0.total_cmp(&b.0));
        costs.into_iter().take(count).map(|(_, x)| x).collect()
    }
}

/// `x` with each parameter in turn moved by [`KICK`] to either side. Of a local minimum in which one
/// parameter that matters little is wrong, the true one is not far from the kick that costs least.
fn kicks(x: &[f64], bounds: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let moved = |i: usize, by: f64| {
        let mut x = x.to_vec();
        x[i] = (x[i] + by).clamp(bounds[i][0], bounds[i][1]);
        x
    };
    (0..x.len())
        .flat_map(|i| [moved(i, -KICK), moved(i, KICK)])
        .collect()
}

/// `x`, and `x` with coordinate `i` at equal steps between its bounds.
fn grid(x: &[f64], i: usize, [low, high]: [f64; 2]) -> Vec<Vec<f64>> {
    let count = ((high - low) / CLEARANCE_STEP).ceil().max(1.0);
    let at = |step: u32| {
        let mut x = x.to_vec();
        x[i] = low + (high - low) * f64::from(step) / count;
        x
    };
    let steps = (0..=count as u32).map(at);
    std::iter::once(x.to_vec()).chain(steps).collect()
}

/// Points around `start`, spread evenly over a quarter of the bounds to either side of it: a Latin
/// hypercube (McKay, Beckman and Conover 1979).
fn spread(start: &[f64], bounds: &[[f64; 2]], seed: u64) -> Vec<Vec<f64>> {
    let mut random = stream(seed, 0, Purpose::Design);
    let count = POINTS_PER_PARAMETER * start.len();
    let mut points = vec![start.to_vec(); count];
    for (i, bound) in bounds.iter().enumerate() {
        let mut places: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            places.swap(last, random.random_range(0..=last));
        }
        for (point, place) in points.iter_mut().zip(places) {
            let share = (place as f64 + 0.5) / count as f64 - 0.5;
            let moved = point[i] + 0.5 * share * (bound[1] - bound[0]);
            point[i] = moved.clamp(bound[0], bound[1]);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_has_equal_steps_between_the_bounds_and_the_point_itself() {
        let grid = grid(&[7.0, 0.1], 1, [-0.3, 0.4]);
        let second: Vec<f64> = grid.iter().map(|x| x[1]).collect();
        assert_eq!(second.len(), 7);
        for (x, expected) in second
            .iter()
            .zip([0.1, -0.3, -0.16, -0.02, 0.12, 0.26, 0.4])
        {
            assert!((x - expected).abs() < 1e-12, "{second:?}");
        }
        assert!(grid.iter().all(|x| x[0] == 7.0));
    }

    #[test]
    fn points_are_spread_evenly_within_the_bounds() {
        let bounds = [[-2.0, 2.0], [0.0, 1.0]];
        let points = spread(&[1.5, 0.5], &bounds, 4);
        assert_eq!(points.len(), 2 * POINTS_PER_PARAMETER);
        for point in &points {
            for (x, [low, high]) in point.iter().zip(&bounds) {
                assert!((low..=high).contains(&x), "{point:?}");
            }
        }
        // Each eighth of half the width around the start holds one point.
        let mut second: Vec<f64> = points.iter().map(|point| point[1]).collect();
        second.sort_by(f64::total_cmp);
        for (i, x) in second.iter().enumerate() {
            assert!((x - (0.25 + 0.5 * (i as f64 + 0.5) / 8.0)).abs() < 1e-12);
        }
        assert_eq!(points, spread(&[1.5, 0.5], &bounds, 4));
    }
}
