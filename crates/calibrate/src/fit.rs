//! From a problem to a calibrated machine.

use crate::error::Error;
use crate::identifiability::{Information, information, is_identifiable, widening};
use crate::likelihood::NOISE;
use crate::likelihood::{Likelihood, misfit};
use crate::observation::Observation;
use crate::optimiser::{self, Genetic, Progress};
use crate::parameter::Parameter;
use crate::prior::{Prior, WithPriors};
use crate::problem::Problem;
use crate::relation::{ClearJoint, clearances};
use crate::search;
use crate::statistical_linearization::statistical_linearization;
use crate::statistics::Statistics;
use nalgebra::DMatrix;
use std::ops::ControlFlow;

/// How a calibration is made.
#[derive(Clone, Debug, PartialEq)]
pub struct FitSettings {
    /// The optimiser.
    pub optimiser: Optimiser,
    /// Seed of a random search.
    pub seed: u64,
    /// Most evaluations of the model, all runs being one.
    pub evaluations: u64,
    /// Runs that are not fitted to, but predicted.
    pub held_out: Vec<String>,
    /// Coordinates from which the search goes on, as [`Progress`] reported them. Without them it starts
    /// at the nominal values.
    pub start: Option<Vec<f64>>,
}

/// How the best fit is searched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Optimiser {
    /// Levenberg and Marquardt from the nominal values, with envelopes and low orders first. Where that
    /// leaves more than noise, from other values too, until the descents agree; then CMA-ES.
    #[default]
    Default,
    /// What the default begins with, up to the end of its first descent.
    FirstDescent,
    /// CMA-ES alone.
    CmaEs,
    /// The genetic algorithm alone.
    Genetic(Genetic),
    /// Levenberg and Marquardt alone.
    LevenbergMarquardt,
}

impl Optimiser {
    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Default => "levenberg-marquardt, cma-es",
            Self::FirstDescent => "levenberg-marquardt, first descent",
            Self::CmaEs => "cma-es",
            Self::Genetic(_) => "genetic",
            Self::LevenbergMarquardt => "levenberg-marquardt",
        }
    }
}

/// A misfit above which the model does not explain the recordings. Intervals follow from the noise, as if it
/// were all that is left. At 1.5 more than half of the mean square is something else, and its effect on the
/// parameters is unknown.
pub const ADEQUATE: f64 = 1.5;
/// A value this near to a bound, as a share of the range, is at it.
const AT_BOUND: f64 = 1e-3;

/// A calibrated machine.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Each parameter with what was found.
    pub estimates: Vec<Estimate>,
    /// Correlation between each pair of estimates, a row and a column per parameter; 0 beside one that is not
    /// identifiable.
    pub correlations: DMatrix<f64>,
    /// Each run's misfit.
    pub runs: Vec<RunFit>,
    /// Evaluations of the model.
    pub evaluations: u64,
    /// False where it was stopped before it had ended.
    pub complete: bool,
}

impl Fit {
    /// Root mean square over runs, those held out or the others; `None` without such runs.
    pub fn misfit(&self, held_out: bool, of: impl Fn(&RunFit) -> f64) -> Option<f64> {
        let chosen: Vec<f64> = self
            .runs
            .iter()
            .filter(|run| run.held_out == held_out)
            .map(|run| of(run).powi(2))
            .collect();
        let mean = chosen.iter().sum::<f64>() / chosen.len() as f64;
        (!chosen.is_empty()).then(|| mean.sqrt())
    }

    /// The coordinates of what was found.
    pub fn coordinates(&self) -> Vec<f64> {
        let coordinate = |e: &Estimate| e.parameter.coordinate(e.value);
        self.estimates.iter().map(coordinate).collect()
    }

    /// Whether no more than noise is left. A model that leaves more may be adequate. A wrong value of the data
    /// sheet may then still have moved the parameters by more than their intervals.
    pub fn is_at_noise(&self) -> bool {
        let fitted = self.misfit(false, |run| run.calibrated);
        self.model_is_adequate() && fitted.is_some_and(|fitted| fitted <= NOISE)
    }

    /// Whether the model explains the recordings: they do if no more than noise is left of the fitted runs, nor of the
    /// held-out runs that have the clearances of a fitted one. Runs at other clearances judge the relation between
    /// clearances, not the parameters.
    pub fn model_is_adequate(&self) -> bool {
        let alike = self.runs.iter().filter(|run| run.held_out && run.alike);
        let squares: Vec<f64> = alike.map(|run| run.calibrated.powi(2)).collect();
        let held_out = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt();
        let fitted = self.misfit(false, |run| run.calibrated);
        fitted.is_some_and(|fitted| fitted <= ADEQUATE) && held_out <= ADEQUATE
    }
}

/// What was found of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value, SI; the nominal one where it is not identifiable.
    pub value: f64,
    /// Its 95 % interval, SI; `None` where it is not identifiable.
    pub interval: Option<[f64; 2]>,
}

impl Estimate {
    /// Whether the best fit lies at a bound of the parameter: the bound says where it ends, and the
    /// recordings ask for more.
    pub fn at_bound(&self) -> bool {
        let [low, high] = self.parameter.box_bounds();
        let x = self.parameter.coordinate(self.value);
        self.interval.is_some() && (x - low).min(high - x) < AT_BOUND * (high - low)
    }
}

/// How far a run is from its prediction, in units of its noise.
#[derive(Clone, Debug, PartialEq)]
pub struct RunFit {
    /// The run.
    pub id: String,
    /// True where it was not fitted to.
    pub held_out: bool,
    /// True where it has the clearances of a run that was fitted to.
    pub alike: bool,
    /// With the nominal parameters.
    pub nominal: f64,
    /// With the calibrated ones.
    pub calibrated: f64,
}

/// Fits the problem's parameters to its runs. `watch` gets the best result so far, and may stop the fit.
///
/// # Errors
/// Nothing to fit, or a machine that cannot be simulated with its nominal parameters.
pub fn calibrate(
    problem: &Problem,
    settings: &FitSettings,
    mut watch: impl FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Fit, Error> {
    let held_out = |id: &str| settings.held_out.iter().any(|held| held == id);
    let fitted = problem.with_runs(|run| !held_out(&run.id));
    if fitted.runs.is_empty() {
        return Err(Error::Nothing(
            "every run is held out: there is none to fit to",
        ));
    }
    if problem.parameters.is_empty() {
        return Err(Error::Nothing("no parameter is given to be fitted"));
    }
    let nominal = vec![0.0; problem.parameters.len()];
    let before = Likelihood::new(problem).by_run(&nominal)?;
    let mut free: Vec<usize> = (0..nominal.len()).collect();
    let mut start = start(problem, settings)?;
    let mut evaluations = 0;
    let mut complete = true;
    let (x, information) = loop {
        let part = fitted.with_parameters(&free);
        let likelihood = Likelihood::new(&part);
        let mut watch = |progress: &Progress| {
            let mut x = nominal.clone();
            for (i, value) in free.iter().zip(&progress.x) {
                x[*i] = *value;
            }
            let answer = watch(&Progress {
                x,
                evaluations: evaluations + progress.evaluations,
                ..progress.clone()
            });
            complete &= answer.is_continue();
            answer
        };
        let found = if free.len() == nominal.len() {
            search(&part, &start, settings, &mut watch)?
        } else {
            // The rest is near its best already.
            let left = settings.evaluations.saturating_sub(evaluations);
            optimiser::levenberg_marquardt(&likelihood, &start, search::CHANGE, left, &mut watch)?
        };
        evaluations += found.evaluations;
        let mut information = information(&likelihood, &found.x);
        evaluations += 1 + optimiser::derivatives(free.len()) + 2 * free.len() as u64;
        if information.unidentifiable.is_none() {
            let whole = Likelihood::new(&fitted);
            let mut x = nominal.clone();
            for (i, value) in free.iter().zip(&found.x) {
                x[*i] = *value;
            }
            let factors = widening(&whole, &x, &free);
            information = information.widened(&factors, &found.x);
            evaluations += 1 + optimiser::derivatives(nominal.len());
        }
        match information.unidentifiable {
            // A parameter that is not identifiable keeps its nominal value, and the rest is fitted again.
            Some(unidentifiable) if complete => {
                start = found.x;
                start.remove(unidentifiable);
                free.remove(unidentifiable);
                if free.is_empty() {
                    break (Vec::new(), None);
                }
            }
            _ => break (found.x, Some(information)),
        }
    };
    let mut all = nominal.clone();
    for (i, value) in free.iter().zip(&x) {
        all[*i] = *value;
    }
    let after = Likelihood::new(problem).by_run(&all)?;
    let found = Found {
        misfits: after.iter().map(|residuals| misfit(residuals)).collect(),
        x: all,
        free,
        information,
        evaluations,
        complete,
    };
    found.fit(problem, &before, held_out)
}

/// The fit of a problem some of whose recorded motions do not repeat themselves, by a statistical linearisation from `start` on.
/// All parameters stay where it leads them, whether they are identifiable or not.
///
/// # Errors
/// As [`statistical_linearization`].
pub(crate) fn linearized(
    problem: &Problem,
    priors: &[Prior],
    start: &[f64],
    far: f64,
    watch: optimiser::Watch,
) -> Result<Fit, Error> {
    let mut complete = true;
    let mut watch = |progress: &Progress| {
        let answer = watch(progress);
        complete &= answer.is_continue();
        answer
    };
    let likelihood = Likelihood::new(problem);
    let statistics = WithPriors {
        inner: &Statistics::new(problem),
        priors,
    };
    let (found, information) = statistical_linearization(&statistics, start, far, &mut watch)?;
    let bounds = problem.parameters.iter().map(|p| p.box_bounds());
    let both = information.intervals.iter().zip(bounds).enumerate();
    let free = both.filter(|(_, (interval, bounds))| is_identifiable(interval, bounds));
    let free: Vec<usize> = free.map(|(i, _)| i).collect();
    let nominal = vec![0.0; problem.parameters.len()];
    let before = likelihood.by_run(&nominal)?;
    let found = Found {
        misfits: mean_misfits(&likelihood, &found.x)?,
        x: found.x,
        information: Some(information.subset(&free)),
        free,
        evaluations: found.evaluations,
        complete,
    };
    found.fit(problem, &before, |_| false)
}

/// The misfit of each run at `x`: the mean square over samples of a motion that scatters.
fn mean_misfits(likelihood: &Likelihood, x: &[f64]) -> Result<Vec<f64>, Error> {
    let samples = likelihood.samples(x);
    let mut squares: Vec<f64> = Vec::new();
    for x in &samples {
        let misfits = likelihood.by_run(x)?;
        squares.resize(misfits.len(), 0.0);
        for (sum, residuals) in squares.iter_mut().zip(&misfits) {
            *sum += misfit(residuals).powi(2);
        }
    }
    let mean = |sum: &f64| (sum / samples.len() as f64).sqrt();
    Ok(squares.iter().map(mean).collect())
}

/// What a search has led to.
struct Found {
    /// Coordinates of all parameters, and the misfit of each run there.
    x: Vec<f64>,
    misfits: Vec<f64>,
    /// Those that are identifiable, and the information of these.
    free: Vec<usize>,
    information: Option<Information>,
    evaluations: u64,
    complete: bool,
}

impl Found {
    /// The fit; `before` are the residuals of each run with the nominal parameters.
    fn fit(
        self,
        problem: &Problem,
        before: &[Vec<f64>],
        held_out: impl Fn(&str) -> bool,
    ) -> Result<Fit, Error> {
        let of_runs = problem.runs.iter().map(|run| &run.settings[..]);
        let joints = ClearJoint::in_runs(&problem.tree, of_runs)?;
        let state = |run: &Observation| clearances(&problem.tree, &joints, &run.settings);
        let fitted = problem.runs.iter().filter(|run| !held_out(&run.id));
        let states = fitted.map(state).collect::<Result<Vec<_>, _>>()?;
        let runs = problem.runs.iter();
        let alike = runs.map(|run| Ok(states.contains(&state(run)?)));
        let alike = alike.collect::<Result<Vec<bool>, Error>>()?;
        let misfits = before.iter().zip(&self.misfits).zip(alike);
        let runs = problem.runs.iter().zip(misfits);
        let information = self.information.as_ref();
        Ok(Fit {
            runs: runs
                .map(|(run, ((before, after), alike))| RunFit {
                    id: run.id.clone(),
                    held_out: held_out(&run.id),
                    alike,
                    nominal: misfit(before),
                    calibrated: *after,
                })
                .collect(),
            estimates: estimates(problem, &self.free, &self.x, information),
            correlations: correlations(self.x.len(), &self.free, information),
            evaluations: self.evaluations,
            complete: self.complete,
        })
    }
}

/// Where the search starts, within the bounds.
fn start(problem: &Problem, settings: &FitSettings) -> Result<Vec<f64>, Error> {
    let count = problem.parameters.len();
    let Some(start) = &settings.start else {
        return Ok(vec![0.0; count]);
    };
    if start.len() != count || start.iter().any(|x| !x.is_finite()) {
        return Err(Error::Optimiser(format!(
            "the start must be {count} finite coordinates, one per parameter; it is {start:?}"
        )));
    }
    let parameters = problem.parameters.iter().zip(start);
    Ok(parameters
        .map(|(parameter, x)| {
            let [low, high] = parameter.box_bounds();
            x.clamp(low, high)
        })
        .collect())
}

/// The best fit by the optimiser of the settings, from `start`.
fn search(
    problem: &Problem,
    start: &[f64],
    settings: &FitSettings,
    watch: optimiser::Watch,
) -> Result<Progress, Error> {
    let most = settings.evaluations;
    let seed = settings.seed;
    let likelihood = Likelihood::new(problem);
    match settings.optimiser {
        Optimiser::Default => search::search(problem, start, seed, most, watch),
        Optimiser::FirstDescent => search::first_descent(problem, start, seed, most, watch),
        Optimiser::LevenbergMarquardt => {
            optimiser::levenberg_marquardt(&likelihood, start, search::CHANGE, most, watch)
        }
        Optimiser::CmaEs => optimiser::cma_es(&likelihood, start, seed, most, watch),
        Optimiser::Genetic(genetic) => optimiser::genetic(&likelihood, &genetic, seed, most, watch),
    }
}

fn estimates(
    problem: &Problem,
    free: &[usize],
    x: &[f64],
    information: Option<&Information>,
) -> Vec<Estimate> {
    let of = |(i, parameter): (usize, &Parameter)| {
        let place = free.iter().position(|f| *f == i);
        let interval = place
            .zip(information)
            .map(|(place, information)| information.intervals[place]);
        Estimate {
            value: parameter.value(x[i]),
            // Beyond its bounds a parameter cannot lie.
            interval: interval.map(|interval| {
                interval.map(|x| {
                    parameter
                        .value(x)
                        .clamp(parameter.bounds[0], parameter.bounds[1])
                })
            }),
            parameter: parameter.clone(),
        }
    };
    problem.parameters.iter().enumerate().map(of).collect()
}

fn correlations(count: usize, free: &[usize], information: Option<&Information>) -> DMatrix<f64> {
    let place = |i: usize| free.iter().position(|f| *f == i);
    DMatrix::from_fn(count, count, |i, j| {
        match (place(i), place(j), information) {
            (Some(i), Some(j), Some(information)) => information.correlations[(i, j)],
            _ if i == j => 1.0,
            _ => 0.0,
        }
    })
}
