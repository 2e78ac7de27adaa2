//! A machine with what was fitted of it, and how far it is from the recordings.

use crate::error::Error;
use crate::fitter::effort::Effort;
use crate::recorded::is_pressure;
use calibrate::Problem;
use calibrate::likelihood::{Likelihood, misfit};
use calibrate::observation::Observation;
use calibrate::prediction::Prediction;
use serde::{Deserialize, Serialize};

/// What a model leaves, in standard deviations of the noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gap {
    /// Of the runs that it was fitted to.
    pub fitted: f64,
    /// Of those held out; none without one.
    pub held_out: Option<f64>,
}

/// A fitted machine.
#[derive(Clone, Debug)]
pub struct Model {
    /// The machine, what is free of it, and all runs, those held out included.
    pub problem: Problem,
    /// Coordinates of the parameters.
    pub x: Vec<f64>,
    /// Standard deviation of the crank angle at which its features may stand, rad: the size of its discrepancy.
    pub timing: f64,
    /// Twice the negative logarithm of the likelihood with this discrepancy, of the runs that are fitted to.
    pub deviance: f64,
    /// The same of those held out; 0 without one.
    pub heldout_deviance: f64,
    /// Misfit of the runs that are fitted to, and of those that are held out, in standard
    /// deviations of the noise; none without a run.
    pub fitted: f64,
    /// See [`Model::fitted`].
    pub held_out: Option<f64>,
    /// Misfit of each run.
    pub by_run: Vec<f64>,
}

impl Model {
    /// The machine at `x` as it stands, with a discrepancy of this size. `x` has a coordinate per parameter, in their
    /// order; those that it does not have are 0.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn at(problem: Problem, x: &[f64], timing: f64, effort: &Effort) -> Result<Self, Error> {
        let mut x = x.to_vec();
        x.resize(problem.parameters.len(), 0.0);
        let by_run = Likelihood::new(&problem).by_run(&x)?;
        let part = |fitted: bool| -> Option<f64> {
            let runs = problem.runs.iter().zip(&by_run);
            let of = runs.filter(|(run, _)| effort.fits(&run.id) == fitted);
            let residuals: Vec<f64> = of.flat_map(|(_, r)| r.iter().copied()).collect();
            (!residuals.is_empty()).then(|| misfit(&residuals))
        };
        let deviance = |fitted: bool| -> Result<f64, Error> {
            let part = problem.with_runs(|run| effort.fits(&run.id) == fitted);
            Ok(Likelihood::coarse(&part, timing).deviance(&x)?)
        };
        Ok(Self {
            deviance: deviance(true)?,
            heldout_deviance: deviance(false)?,
            fitted: part(true).unwrap_or(f64::NAN),
            held_out: part(false),
            by_run: by_run.iter().map(|residuals| misfit(residuals)).collect(),
            problem,
            x,
            timing,
        })
    }

    /// What it leaves.
    pub(crate) fn gap(&self) -> Gap {
        Gap {
            fitted: self.fitted,
            held_out: self.held_out,
        }
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
}
