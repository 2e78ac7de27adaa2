//! Fits a machine to its recordings: descents from a start, and searches out of local minima.

use crate::criteria::NOISE;
use crate::effort::{Effort, FIRST_SEARCH, SEARCH};
use crate::error::Error;
use crate::journal::Finished;
use crate::model::Model;
use crate::recorded::is_of_pressures;
pub(crate) use calibrate::LOOSE;
use calibrate::fit::{Estimate, Fit, FitSettings, Optimiser};
use calibrate::likelihood::Likelihood;
use calibrate::observation::Observation;
use calibrate::optimiser::{LeastSquares, Progress, levenberg_marquardt};
use calibrate::{Problem, nearer_half};
use std::ops::ControlFlow;

/// Relative change of the sum of squares at which a rough and a full descent end.
const ROUGH: f64 = 1e-2;
const FULL: f64 = 1e-4;
/// The same for pressures alone, whose descents have no minima on the way.
const FULL_OF_GAS: f64 = 1e-3;
/// A descent from where the nearer runs have led is worth another one if it leaves less than this share.
const BETTER: f64 = 0.95;
/// Most evaluations of a descent of which no more is asked than whether it leads near.
pub(crate) const FEW_EVALUATIONS: u64 = 25;
/// Runs that the first fits of candidates use.
const FEW: usize = 3;
/// Share of the range by which a descent starts within a bound.
const INSIDE: f64 = 0.01;

/// By how much features may stand elsewhere in a rough look at a problem, rad. Pressures do not ring:
/// nothing in them is in the way of a descent, and where their valves work counts from the start.
pub(crate) fn loose(problem: &Problem) -> f64 {
    match is_of_pressures(problem) {
        true => 0.0,
        false => LOOSE,
    }
}

/// Asked between evaluations whether to go on.
pub type Watch<'a> = &'a (dyn Fn() -> ControlFlow<()> + Sync);

/// Fits models.
#[derive(Clone, Copy)]
pub(crate) struct Fitter<'a> {
    pub effort: &'a Effort,
    pub watch: Watch<'a>,
    /// Told what is being done, and the misfit so far.
    pub say: &'a (dyn Fn(&str, f64) + Sync),
}

impl<'a> Fitter<'a> {
    /// The same with another effort.
    pub fn having(&self, effort: &'a Effort) -> Self {
        Self { effort, ..*self }
    }

    /// The best fit that descents from `start` lead to: rough first, then full. A fit that leaves more than noise
    /// restarts from the better-fitting runs alone, then continues with all. Pressures alone need the full one only.
    /// `start` has a coordinate per parameter; those that it does not have start at 0.
    ///
    /// # Errors
    /// A machine that cannot be simulated; [`Error::Stopped`].
    pub fn fit(&self, problem: Problem, start: &[f64]) -> Result<Model, Error> {
        self.fit_within(problem, start, self.effort.evaluations)
    }

    /// A model that is fitted with few evaluations.
    pub fn rough(&self, problem: Problem, start: &[f64]) -> Result<Model, Error> {
        self.fit_within(problem, start, FEW_EVALUATIONS)
    }

    /// As [`Fitter::fit`], with at most so many evaluations of each descent.
    pub fn fit_within(
        &self,
        problem: Problem,
        start: &[f64],
        evaluations: u64,
    ) -> Result<Model, Error> {
        let effort = self.effort;
        if problem.parameters.is_empty() {
            return Model::at(problem, &[], effort);
        }
        let mut start = start.to_vec();
        start.resize(problem.parameters.len(), 0.0);
        let fitted = problem.with_runs(|run| effort.fits(&run.id)).metered();
        let descents = || {
            let mut x = start.clone();
            let mut change = FULL_OF_GAS;
            let within = || ((self.watch)(), fitted.meter.steps() < SEARCH);
            let loose = loose(&fitted);
            if loose > 0.0 {
                let rough = Likelihood::coarse(&fitted, loose);
                let rough = descend(&rough, &x, ROUGH, evaluations, &within)?;
                (x, change) = (rough.x, FULL);
            }
            let full = |problem: &Problem, x: &[f64]| {
                descend(&Likelihood::new(problem), x, change, evaluations, &within)
            };
            let mut best = full(&fitted, &x)?;
            while loose > 0.0
                && best.misfit() > NOISE
                && let Some(half) = nearer_half(&fitted, &best.x)
            {
                let led = full(&half, &best.x).and_then(|near| full(&fitted, &near.x));
                let after = match led {
                    // A descent may end where the machine cannot be simulated.
                    Err(Error::Fit(_)) => break,
                    led => led?,
                };
                let better = after.misfit() < BETTER * best.misfit();
                if after.cost < best.cost {
                    best = after;
                }
                if !better {
                    break;
                }
            }
            Ok(Finished {
                numbers: best.x,
                cost: fitted.meter.steps(),
            })
        };
        let input = ("fit", &fitted, &start, evaluations);
        let x = effort.journal.once(&input, descents)?;
        Model::at(problem, &x, effort)
    }

    /// The problem's machine, calibrated as well as it can be with so many evaluations.
    pub fn searched(
        &self,
        problem: &Problem,
        start: Option<Vec<f64>>,
        evaluations: u64,
    ) -> Result<Model, Error> {
        let settings = FitSettings {
            optimiser: Optimiser::Default,
            seed: 0,
            evaluations,
            held_out: self.effort.held_out.clone(),
            start,
        };
        let metered = problem.metered();
        let most = match settings.start {
            None => FIRST_SEARCH,
            Some(_) => SEARCH,
        };
        let watch = |_: &_| match metered.meter.steps() < most {
            true => (self.watch)(),
            false => ControlFlow::Break(()),
        };
        let search = || {
            let fit = calibrate::calibrate(&metered, &settings, watch)?;
            if !fit.complete && (self.watch)().is_break() {
                return Err(Error::Stopped);
            }
            let coordinate = |e: &Estimate| e.parameter.coordinate(e.value);
            Ok(Finished {
                numbers: fit.estimates.iter().map(coordinate).collect(),
                cost: metered.meter.steps(),
            })
        };
        let x = self.effort.journal.once(&(problem, &settings), search)?;
        Model::at(problem.clone(), &x, self.effort)
    }

    /// The parameters of a model with their bounds.
    pub fn bounds(&self, model: &Model) -> Result<Fit, Error> {
        let settings = FitSettings {
            optimiser: Optimiser::LevenbergMarquardt,
            seed: 0,
            evaluations: self.effort.evaluations,
            held_out: self.effort.held_out.clone(),
            start: Some(model.x.clone()),
        };
        let fit = calibrate::calibrate(&model.problem, &settings, |_| (self.watch)())?;
        Ok(fit)
    }

    /// The model with a few of the runs that it is fitted to, of speeds as different as there are.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn few(&self, model: &Model) -> Result<Model, Error> {
        let runs = model.problem.runs.iter();
        let mut runs: Vec<_> = runs.filter(|run| self.effort.fits(&run.id)).collect();
        runs.sort_by(|a, b| a.crank.speed.total_cmp(&b.crank.speed));
        let last = runs.len().saturating_sub(1);
        let parts = FEW.saturating_sub(1).max(1);
        let chosen: Vec<&str> = (0..FEW)
            .filter_map(|i| runs.get(i * last / parts))
            .map(|r| r.id.as_str())
            .collect();
        let chosen = |run: &Observation| chosen.contains(&run.id.as_str());
        Model::at(model.problem.with_runs(chosen), &model.x, self.effort)
    }
}

/// A descent. `watch` decides whether to go on, and whether there are steps left for that.
fn descend(
    likelihood: &Likelihood,
    start: &[f64],
    change: f64,
    evaluations: u64,
    watch: &dyn Fn() -> (ControlFlow<()>, bool),
) -> Result<Progress, Error> {
    let mut stopped = false;
    let bounds = likelihood.bounds();
    // A descent within bounds does not leave one that it starts at.
    let within = start.iter().zip(&bounds).map(|(x, [low, high])| {
        let margin = INSIDE * (high - low);
        x.clamp(low + margin, high - margin)
    });
    let start: Vec<f64> = within.collect();
    let found = levenberg_marquardt(likelihood, &start, change, evaluations, &mut |_| {
        let (answer, affordable) = watch();
        stopped |= answer.is_break();
        match affordable {
            true => answer,
            false => ControlFlow::Break(()),
        }
    })?;
    if stopped {
        Err(Error::Stopped)
    } else {
        Ok(found)
    }
}
