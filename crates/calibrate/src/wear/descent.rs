//! Descents from what is slow in the recordings to what is fast.
//!
//! Energies have few minima and come first, then lines that may stand elsewhere in the revolution, with less and less of
//! that. Of many starts a third goes on after each stage.

use super::discrepancy::{FAR, TIMINGS};
use super::effort::Effort;
use super::model::Model;
use crate::branch::{EVALUATIONS, on_best_branches};
use crate::cloud_descent::{KEPT, Led};
use crate::energies::Energies;
use crate::error::Error;
use crate::fit::{Fit, FitSettings, Optimiser, calibrate, linearized};
use crate::likelihood::{Likelihood, misfit};
use crate::observation::Observation;
use crate::optimiser::{LeastSquares, Progress, levenberg_marquardt};
use crate::prior::{self, Prior, WithPriors};
use crate::problem::Problem;
use crate::search::CHANGE;
use crate::secant::secants;
use rayon::prelude::*;

/// What a stage compares, and the evaluations that it may take.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// Energies by band and sector.
    Energies(u64),
    /// Lines that may stand elsewhere by so much, rad.
    Lines(f64, u64),
}

/// The stages with a few of the runs, after each of which a third of the starts goes on.
const ROUGH: [Stage; 3] = [
    Stage::Energies(12),
    Stage::Lines(0.01, 10),
    Stage::Lines(0.003, 12),
];
/// The stages with all runs.
const FINE: [Stage; 4] = [
    Stage::Lines(0.01, 20),
    Stage::Lines(0.003, 20),
    Stage::Lines(0.001, 20),
    Stage::Lines(0.0, 40),
];
/// Runs that are looked at roughly.
const RUNS: usize = 3;
/// Rough descents before the search may be stopped.
const AT_ONCE: usize = 16;
/// Ends of rough descents that are followed with all runs.
const FOLLOWED: usize = 3;
/// Relative change of the sum of squares at which a stage ends.
const ENDED: f64 = 1e-2;
/// By how much a coordinate of a clearance is moved to where a motion repeats itself: less than the width of a minimum of lines.
const BESIDE: [f64; 6] = [-1e-3, -3e-4, -1e-4, 1e-4, 3e-4, 1e-3];
/// Most evaluations of the last descent, and of its beginning: what is still far from the recordings then is another minimum,
/// which is not looked at any closer.
const LAST: u64 = 300;
const BEGINNING: u64 = 30;

/// The problem with a few of its runs, of speeds as different as there are.
pub(super) fn few(problem: &Problem) -> Problem {
    let mut runs: Vec<&Observation> = problem.runs.iter().collect();
    runs.sort_by(|a, b| a.crank.speed.total_cmp(&b.crank.speed));
    let last = runs.len().saturating_sub(1);
    let chosen: Vec<String> = (0..RUNS)
        .filter_map(|i| runs.get(i * last / (RUNS - 1)))
        .map(|run| run.id.clone())
        .collect();
    problem.with_runs(|run| chosen.contains(&run.id))
}

/// Where short descents from these starts lead with a few of the runs, the best first.
pub(super) fn roughly(model: &Model, starts: &[Vec<f64>], effort: &mut Effort) -> Vec<Led> {
    let part = few(&model.problem);
    let at = |x: &Vec<f64>| Led {
        x: x.clone(),
        left: f64::INFINITY,
    };
    let mut led: Vec<Led> = starts.iter().map(at).collect();
    for stage in ROUGH {
        for together in led.chunks_mut(AT_ONCE) {
            if effort.stopped {
                break;
            }
            let spent = descend(&part, &model.priors, together, stage);
            effort.evaluated(spent);
        }
        led.sort_by(|a, b| a.left.total_cmp(&b.left));
        led.truncate(led.len().div_ceil(KEPT).max(FOLLOWED));
    }
    led
}

/// The best coordinates that descents from these ends lead to with all runs.
pub(super) fn finely(model: &Model, led: Vec<Led>, effort: &mut Effort) -> Result<Vec<f64>, Error> {
    let mut ends: Vec<Led> = led.into_iter().take(FOLLOWED).collect();
    for stage in FINE {
        if effort.stopped {
            break;
        }
        let spent = descend(&model.problem, &model.priors, &mut ends, stage);
        effort.evaluated(spent);
    }
    ends.sort_by(|a, b| a.left.total_cmp(&b.left));
    let best = ends.into_iter().next();
    best.map(|best| best.x)
        .ok_or(Error::Nothing("no descent has led anywhere"))
}

/// One stage of these descents, and the evaluations that they have taken. Where the machine cannot be simulated, nothing is moved.
fn descend(problem: &Problem, priors: &[Prior], all: &mut [Led], stage: Stage) -> u64 {
    let starts: Vec<Vec<f64>> = all.iter().map(|led| led.x.clone()).collect();
    let (ends, spent, left) = match stage {
        Stage::Energies(most) => {
            let energies = Energies::new(problem);
            let (ends, spent) = descents(&energies, priors, &starts, most);
            let left = energies.squares_of_all(&ends).into_iter();
            let left: Vec<Option<f64>> = left.map(Result::ok).collect();
            (ends, spent, left)
        }
        Stage::Lines(timing, most) => {
            let lines = Likelihood::in_parts(problem, timing);
            let (ends, spent) = descents(&lines, priors, &starts, most);
            let left = lines.likeliest_of_all(&ends, &TIMINGS).into_iter();
            let left = left.map(|found| found.ok().map(|(_, left)| left));
            let left: Vec<Option<f64>> = left.collect();
            (ends, spent, left)
        }
    };
    for ((led, x), left) in all.iter_mut().zip(ends).zip(left) {
        match left {
            Some(left) => {
                led.left = left + prior::squares(priors, &x);
                led.x = x;
            }
            None => led.left = f64::INFINITY,
        }
    }
    spent
}

/// Where descents lead from these starts, and the evaluations that they have taken.
fn descents(
    compared: &(impl LeastSquares + Sync),
    priors: &[Prior],
    starts: &[Vec<f64>],
    most: u64,
) -> (Vec<Vec<f64>>, u64) {
    let compared = WithPriors {
        inner: compared,
        priors,
    };
    let found = secants(&compared, starts, ENDED, most);
    let spent = found.iter().map(|found| found.evaluations).sum();
    (found.into_iter().map(|found| found.x).collect(), spent)
}

/// The fit of a model from `x`, with intervals, on the motions that explain the recordings best. What is not identifiable there
/// keeps its value.
///
/// # Errors
/// As [`calibrate`].
pub(super) fn fit(model: &mut Model, x: Vec<f64>, effort: &mut Effort) -> Result<Fit, Error> {
    if !model.problem.runs.iter().all(Observation::repeats) {
        return without_derivatives(model, &x, effort);
    }
    branch(model, &x, effort);
    let x = repeating(&model.problem, x, effort);
    if !repeats(&model.problem, &x) {
        return without_derivatives(model, &x, effort);
    }
    let mut led = Progress {
        x,
        cost: f64::INFINITY,
        count: 1,
        evaluations: 0,
    };
    for most in [BEGINNING, LAST] {
        branch(model, &led.x, effort);
        let likelihood = Likelihood::new(&model.problem);
        let mut watch = |progress: &Progress| effort.shown(progress.evaluations);
        led = levenberg_marquardt(&likelihood, &led.x, CHANGE, most, &mut watch)?;
        effort.spent += led.evaluations;
        if led.misfit() > FAR {
            break;
        }
    }
    let most = if led.misfit() > FAR { 1 } else { LAST };
    branch(model, &led.x, effort);
    let mut problem = model.problem.clone();
    for (parameter, x) in problem.parameters.iter_mut().zip(&led.x) {
        parameter.nominal = parameter.value(*x);
    }
    let settings = FitSettings {
        optimiser: Optimiser::LevenbergMarquardt,
        seed: 0,
        evaluations: most,
        held_out: Vec::new(),
        start: None,
    };
    let mut fit = calibrate(&problem, &settings, |progress| {
        effort.fitted(progress.misfit());
        effort.shown(progress.evaluations)
    })?;
    effort.spent += fit.evaluations;
    for (estimate, parameter) in fit.estimates.iter_mut().zip(&model.problem.parameters) {
        estimate.parameter = parameter.clone();
    }
    let end = fit.coordinates();
    match fit.complete && !repeats(&model.problem, &end) {
        true => without_derivatives(model, &end, effort),
        false => Ok(fit),
    }
}

/// Puts the runs on the motions near `x` that explain them best.
fn branch(model: &mut Model, x: &[f64], effort: &mut Effort) {
    model.problem = on_best_branches(&model.problem, x);
    effort.evaluated(EVALUATIONS);
}

/// The fit from `x` of a motion that does not repeat itself.
fn without_derivatives(model: &Model, x: &[f64], effort: &mut Effort) -> Result<Fit, Error> {
    let mut watch = |progress: &Progress| {
        effort.fitted(progress.misfit());
        effort.shown(progress.evaluations)
    };
    let fit = linearized(&model.problem, &model.priors, x, FAR, &mut watch)?;
    effort.spent += fit.evaluations;
    Ok(fit)
}

/// Whether the motion of every run repeats itself at these coordinates.
pub(super) fn repeats(problem: &Problem, x: &[f64]) -> bool {
    let all = Likelihood::new(problem).predictions(x);
    all.is_ok_and(|all| all.iter().all(|prediction| prediction.periodic))
}

/// The coordinates `x`, where the motion repeats itself there. Elsewhere those beside them whose
/// motion repeats itself and explains the recordings best: a motion that is about to double its period settles slowly, and has no
/// derivatives.
fn repeating(problem: &Problem, x: Vec<f64>, effort: &mut Effort) -> Vec<f64> {
    if repeats(problem, &x) {
        return x;
    }
    let likelihood = Likelihood::new(problem);
    let clearances = problem.parameters.iter().enumerate();
    let clearances = clearances.filter(|(_, parameter)| parameter.is_clearance());
    let beside = clearances.flat_map(|(place, _)| {
        let x = &x;
        BESIDE.map(move |by| {
            let mut x = x.clone();
            x[place] += by;
            x
        })
    });
    let beside: Vec<Vec<f64>> = beside.collect();
    effort.evaluated(2 * beside.len() as u64);
    let measured = beside.par_iter().filter(|x| repeats(problem, x));
    let measured = measured.map(|x| (misfit(&likelihood.residuals(x)), x.clone()));
    let measured: Vec<(f64, Vec<f64>)> = measured.collect();
    let best = measured.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(x, |(_, x)| x)
}
