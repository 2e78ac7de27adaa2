//! A machine with what was fitted of it, and how far it is from the recordings.

use crate::decision::NOISE;
use crate::error::Error;
use crate::journal::{Finished, Journal};
use crate::pressures::{is_of_pressures, is_pressure};
use crate::steps::Gap;
use calibrate::likelihood::{Likelihood, misfit};
use calibrate::observation::Observation;
use calibrate::optimiser::{LeastSquares, Progress, levenberg_marquardt};
use calibrate::prediction::Prediction;
use calibrate::{Problem, nearer_half};
use std::ops::ControlFlow;

/// Relative change of the sum of squares at which a rough and a full descent end.
const ROUGH: f64 = 1e-2;
const FULL: f64 = 1e-4;
/// The same for pressures alone, whose descents have no minima on the way.
const FULL_OF_GAS: f64 = 1e-3;
/// A descent from where the nearer runs have led is worth another one if it leaves less than this share.
const BETTER: f64 = 0.95;
/// What an explanation may cost before nothing new is begun, in steps of the integrator for each
/// throw: a step of two joints takes some 7 µs. Then what a search from the nominal machine may cost,
/// and one that goes on from another.
const BUDGET: u64 = 24_000_000;
/// By how much more it may cost for each effect that was found, so that what is left has its chance too.
const FOR_ANOTHER: u64 = BUDGET * 3 / 4;
/// By how much more where another effect is looked for beside wear.
const BESIDE_WEAR: u64 = BUDGET / 2;
/// And by how much more before the search of a force of no name goes into its second and third attempts.
const FOR_FORCE: u64 = BUDGET / 2;
pub(crate) const FIRST_SEARCH: u64 = BUDGET / 2;
pub(crate) const SEARCH: u64 = BUDGET / 4;
/// Share of the range by which a descent starts within a bound.
const INSIDE: f64 = 0.01;
/// By how much features may stand elsewhere in a rough descent, rad: as in a calibration.
pub(crate) const LOOSE: f64 = 0.01;

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

/// A fitted machine.
#[derive(Clone, Debug)]
pub struct Model {
    /// The machine, what is free of it, and all runs, those held out included.
    pub problem: Problem,
    /// Coordinates of the parameters.
    pub x: Vec<f64>,
    /// Misfit of the runs that are fitted to, and of those that are held out, in standard
    /// deviations of the noise; none without a run.
    pub fitted: f64,
    /// See [`Model::fitted`].
    pub held_out: Option<f64>,
    /// Misfit of each run.
    pub by_run: Vec<f64>,
}

/// Which runs a model is fitted to, and how long it may take.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Runs that are predicted only.
    pub held_out: Vec<String>,
    /// Most evaluations of a descent.
    pub evaluations: u64,
    /// Whether no run that is fitted to repeats itself: then many revolutions of each are compared.
    pub chaotic: bool,
    /// What was found before.
    pub journal: Journal,
    /// Effects that were found in this explanation.
    pub found: usize,
}

impl Effort {
    /// The effort for a problem of which these runs are held out. So are those in which the recording or
    /// the nominal machine does not repeat itself, if others are left: there are no derivatives.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn new(
        problem: &Problem,
        mut held_out: Vec<String>,
        evaluations: u64,
        journal: Journal,
    ) -> Result<Self, Error> {
        let nominal = vec![0.0; problem.parameters.len()];
        let predictions = Likelihood::new(problem).predictions(&nominal)?;
        let runs = problem.runs.iter().zip(&predictions);
        let (periodic, others): (Vec<_>, Vec<_>) =
            runs.partition(|(run, shown)| shown.periodic && run.repeats_like(&problem.runs));
        let chaotic = !periodic.iter().any(|(run, _)| !held_out.contains(&run.id));
        if !chaotic {
            for (run, _) in others {
                if !held_out.contains(&run.id) {
                    held_out.push(run.id.clone());
                }
            }
        }
        Ok(Self {
            held_out,
            evaluations,
            chaotic,
            journal,
            found: 0,
        })
    }

    /// The same where so many effects were found.
    pub(crate) fn having(&self, found: usize) -> Self {
        Self {
            found,
            ..self.clone()
        }
    }

    /// Whether there is still something left of the budget.
    pub(crate) fn goes_on(&self) -> bool {
        self.journal.spent() < self.budget()
    }

    /// The same for the search of another effect beside wear.
    pub(crate) fn goes_on_beside_wear(&self) -> bool {
        self.journal.spent() < self.budget() + BESIDE_WEAR
    }

    /// The same for the search of a force of no name.
    pub(crate) fn goes_on_for_force(&self) -> bool {
        self.journal.spent() < self.budget() + FOR_FORCE
    }

    fn budget(&self) -> u64 {
        BUDGET + self.found as u64 * FOR_ANOTHER
    }

    fn fits(&self, run: &str) -> bool {
        !self.held_out.iter().any(|held| held == run)
    }
}

impl Model {
    /// The machine at `x` as it stands.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn at(problem: Problem, x: Vec<f64>, effort: &Effort) -> Result<Self, Error> {
        let by_run = Likelihood::new(&problem).by_run(&x)?;
        let part = |fitted: bool| -> Option<f64> {
            let runs = problem.runs.iter().zip(&by_run);
            let of = runs.filter(|(run, _)| effort.fits(&run.id) == fitted);
            let residuals: Vec<f64> = of.flat_map(|(_, r)| r.iter().copied()).collect();
            (!residuals.is_empty()).then(|| misfit(&residuals))
        };
        Ok(Self {
            fitted: part(true).unwrap_or(f64::NAN),
            held_out: part(false),
            by_run: by_run.iter().map(|residuals| misfit(residuals)).collect(),
            problem,
            x,
        })
    }

    /// The best fit that descents from `start` lead to: rough first, then full; where that leaves more than
    /// noise, the nearer runs by themselves, and from there all. Pressures alone need the full one only.
    ///
    /// # Errors
    /// A machine that cannot be simulated; [`Error::Stopped`].
    pub fn fit(
        problem: Problem,
        start: &[f64],
        effort: &Effort,
        watch: Watch,
    ) -> Result<Self, Error> {
        if problem.parameters.is_empty() {
            return Self::at(problem, Vec::new(), effort);
        }
        let fitted = problem.with_runs(|run| effort.fits(&run.id)).metered();
        let descents = || {
            let mut x = start.to_vec();
            let mut change = FULL_OF_GAS;
            let within = || (watch(), fitted.meter.steps() < SEARCH);
            let loose = loose(&fitted);
            if loose > 0.0 {
                let rough = Likelihood::coarse(&fitted, loose);
                let rough = descend(&rough, &x, ROUGH, effort, &within)?;
                (x, change) = (rough.x, FULL);
            }
            let full = |problem: &Problem, x: &[f64]| {
                descend(&Likelihood::new(problem), x, change, effort, &within)
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
        let input = ("fit", &fitted, start, effort.evaluations);
        let x = effort.journal.once(&input, descents)?;
        Self::at(problem, x, effort)
    }

    /// What it leaves.
    pub(crate) fn gap(&self) -> Gap {
        Gap {
            fitted: self.fitted,
            held_out: self.held_out,
        }
    }

    /// The misfit of each run, by its name.
    pub(crate) fn misfits(&self) -> Vec<(String, f64)> {
        let runs = self.problem.runs.iter().map(|run| run.id.clone());
        runs.zip(self.by_run.iter().copied()).collect()
    }

    /// Root mean square over the revolution of simulated less recorded pressure in each run that has
    /// pressures, Pa, as far as their orders are compared.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn pressure_rms(&self) -> Result<Vec<(String, f64)>, Error> {
        let predictions = Likelihood::new(&self.problem).predictions(&self.x)?;
        let runs = self.problem.runs.iter().zip(&predictions);
        let of_run = |(run, shown): (&Observation, &Prediction)| {
            let channels = run.channels.iter().zip(&shown.lines);
            let pressures = channels.filter(|(channel, _)| is_pressure(channel));
            let squares: Vec<f64> = pressures
                .map(|(channel, shown)| {
                    let of = |k: &usize| {
                        let shown = shown.amplitude.get(*k).copied().unwrap_or_default();
                        let parts = if *k == 0 { 1.0 } else { 2.0 };
                        (shown - channel.lines.amplitude[*k]).norm_sqr() / parts
                    };
                    channel.orders.iter().map(of).sum()
                })
                .collect();
            let mean = squares.iter().sum::<f64>() / squares.len() as f64;
            (!squares.is_empty()).then(|| (run.id.clone(), mean.sqrt()))
        };
        Ok(runs.filter_map(of_run).collect())
    }

    /// Schwarz's criterion of `after`, which has the same runs, less that of this model.
    pub(crate) fn bic_to(&self, after: &Self) -> f64 {
        self.bic_with(after.fitted, after.x.len() as f64 - self.x.len() as f64)
    }

    /// The same of a model with so many more parameters, which leaves the misfit `fitted`.
    pub(crate) fn bic_with(&self, fitted: f64, extra: f64) -> f64 {
        let count = self.observations();
        count * (fitted.powi(2) - self.fitted.powi(2)) + extra * count.ln()
    }

    /// Schwarz's criterion with the variance of what is left taken from the residuals themselves,
    /// n ln σ² + k ln n, per observation: of models that leave more than noise the one with less of
    /// it is better, unless its misfit is smaller by its number of parameters alone. A line counts once
    /// here: what a wrong model leaves is no independent noise.
    pub(crate) fn criterion(&self) -> f64 {
        let count = 0.5 * self.observations();
        2.0 * self.fitted.ln() + self.x.len() as f64 * count.ln() / count
    }

    /// Each line of an order counts as two observations.
    fn observations(&self) -> f64 {
        let channels = self.problem.runs.iter().flat_map(|run| &run.channels);
        channels.map(|c| 2 * c.orders.len()).sum::<usize>() as f64
    }

    /// The better of two; the first where they are as good.
    #[must_use]
    pub fn better(self, other: Self) -> Self {
        if other.fitted < self.fitted {
            other
        } else {
            self
        }
    }
}

/// A descent; `watch` tells whether to go on, and whether there are steps left for that.
fn descend(
    likelihood: &Likelihood,
    start: &[f64],
    change: f64,
    effort: &Effort,
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
    let found = levenberg_marquardt(likelihood, &start, change, effort.evaluations, &mut |_| {
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
