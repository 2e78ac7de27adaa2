//! A machine with what was fitted of it, and how far it is from the recordings.

use crate::error::Error;
use calibrate::Problem;
use calibrate::likelihood::{Likelihood, misfit};
use calibrate::optimiser::{LeastSquares, Progress, levenberg_marquardt};
use std::ops::ControlFlow;

/// Relative change of the sum of squares at which a rough and a full descent end.
const ROUGH: f64 = 1e-2;
const FULL: f64 = 1e-4;
/// By how much features may stand elsewhere in a rough descent, rad: as in a calibration.
pub(crate) const LOOSE: f64 = 0.01;

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
}

impl Effort {
    /// The effort for a problem of which these runs are held out. So are those in which the nominal
    /// machine does not repeat itself, if others are left: they have no derivatives.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn new(
        problem: &Problem,
        mut held_out: Vec<String>,
        evaluations: u64,
    ) -> Result<Self, Error> {
        let nominal = vec![0.0; problem.parameters.len()];
        let predictions = Likelihood::new(problem).predictions(&nominal)?;
        let runs = problem.runs.iter().zip(&predictions);
        let (periodic, others): (Vec<_>, Vec<_>) = runs.partition(|(_, shown)| shown.periodic);
        if periodic.iter().any(|(run, _)| !held_out.contains(&run.id)) {
            for (run, _) in others {
                if !held_out.contains(&run.id) {
                    held_out.push(run.id.clone());
                }
            }
        }
        Ok(Self {
            held_out,
            evaluations,
        })
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

    /// The best fit that descents from `start` lead to: rough first, then full.
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
        let fitted = problem.with_runs(|run| effort.fits(&run.id));
        let rough = descend(
            &Likelihood::coarse(&fitted, LOOSE),
            start,
            ROUGH,
            effort,
            watch,
        )?;
        let likelihood = Likelihood::new(&fitted);
        let full = descend(&likelihood, &rough.x, FULL, effort, watch)?;
        Self::at(problem, full.x, effort)
    }

    /// The same with other free parameters held where they are, by their paths.
    pub fn frozen(&self, free: impl Fn(&str) -> bool) -> Result<(Problem, Vec<f64>), Error> {
        let mut problem = self.problem.clone();
        let mut x = Vec::new();
        problem.parameters.clear();
        for (parameter, coordinate) in self.problem.parameters.iter().zip(&self.x) {
            if free(&parameter.path) || parameter.run.is_some() {
                problem.parameters.push(parameter.clone());
                x.push(*coordinate);
            } else {
                parameter.write(&mut problem.tree, parameter.value(*coordinate))?;
            }
        }
        Ok((problem, x))
    }

    /// The misfit of each run, by its name.
    pub(crate) fn misfits(&self) -> Vec<(String, f64)> {
        let runs = self.problem.runs.iter().map(|run| run.id.clone());
        runs.zip(self.by_run.iter().copied()).collect()
    }

    /// Schwarz's criterion of `after`, which has the same runs, less that of this model; each line of
    /// an order counts as two observations.
    pub(crate) fn bic_to(&self, after: &Self) -> f64 {
        let channels = after.problem.runs.iter().flat_map(|run| &run.channels);
        let count = channels.map(|c| 2 * c.orders.len()).sum::<usize>() as f64;
        let extra = after.x.len() as f64 - self.x.len() as f64;
        count * (after.fitted.powi(2) - self.fitted.powi(2)) + extra * count.ln()
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

fn descend(
    likelihood: &Likelihood,
    start: &[f64],
    change: f64,
    effort: &Effort,
    watch: Watch,
) -> Result<Progress, Error> {
    let mut stopped = false;
    let bounds = likelihood.bounds();
    let within = start.iter().zip(&bounds).map(|(x, b)| x.clamp(b[0], b[1]));
    let start: Vec<f64> = within.collect();
    let found = levenberg_marquardt(likelihood, &start, change, effort.evaluations, &mut |_| {
        let answer = watch();
        stopped |= answer.is_break();
        answer
    })?;
    if stopped {
        Err(Error::Stopped)
    } else {
        Ok(found)
    }
}
