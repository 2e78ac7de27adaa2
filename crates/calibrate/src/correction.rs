//! Which value of the data sheet is wrong, where a calibrated machine leaves more than noise of its recordings.
//!
//! 1. Rank the values in doubt by the misfit that each leaves to first order. What was fitted adapts to it: the
//!    derivative of the residuals by the value is freed of what the fitted parameters can imitate. A wrong value
//!    leads a calibration astray, so this is done at the nominal machine as well as where the calibration has ended.
//! 2. Fit the best few, each together with everything else.
//! 3. Compare those that explain the recordings by their evidence. It is exp(−χ²/2), times the density of the prior
//!    at the fitted value, times the width that the recordings leave it (Laplace's approximation, MacKay 1992).
//!
//! This is done twice:
//!
//! 1. By descents alone, as soon as the first descent of a calibration has ended above the noise. A search that a
//!    wrong value leads astray is long and in vain.
//! 2. Thoroughly, where the search has ended above the noise too.
//!
//! A value is corrected where its probability is clear and its interval excludes the stated value. Several
//! values that explain the recordings equally well are rivals, and none is corrected.

use crate::data_sheet::{Doubt, doubts};
use crate::error::Error;
use crate::fit::{ADEQUATE, Estimate, Fit, FitSettings, Optimiser, calibrate};
use crate::likelihood::Likelihood;
use crate::likelihood::NOISE;
use crate::normal::QUANTILE;
use crate::optimiser::{self, LeastSquares, Progress};
use crate::problem::Problem;
use crate::promise::{promises, split};
use crate::search;
use nalgebra::DVector;
use std::ops::ControlFlow;

/// Values that are fitted, of those that were ranked: the linear ranking may be wrong.
const FITTED: usize = 5;
/// Most evaluations of a descent for a value.
const DESCENT: u64 = 60;
/// Most evaluations of the search that follows where no descent has reached the noise.
const TRIED: u64 = 300;
/// The best values that are searched for so.
const SEARCHED: usize = 2;
/// Probability from which one value alone is corrected.
const CLEAR: f64 = 0.95;
/// Probability below which a rival is not named.
const RIVAL: f64 = 0.01;
/// A value whose prior, over its width, moves the residuals by less than this (noise is 1 each) is not felt.
const FELT: f64 = 1.0;

/// A value of the data sheet that would explain the recordings.
#[derive(Clone, Debug)]
pub struct Correction {
    /// What was found of it.
    pub estimate: Estimate,
    /// Whether the data sheet states it. A filter that is not stated has no nominal value.
    pub stated: bool,
    /// Probability among the values in doubt.
    pub probability: f64,
    /// Misfit of the fitted runs with it.
    pub misfit: f64,
}

/// What has become of a fit that did not explain the recordings.
#[derive(Clone, Debug)]
pub struct Corrected {
    /// The problem with the corrected value free, and its fit; none where nothing was corrected.
    pub fit: Option<(Problem, Fit)>,
    /// Whether that has the first of the corrections.
    pub applied: bool,
    /// Values each of which would explain the recordings, the most probable first.
    pub corrections: Vec<Correction>,
    /// Paths of all values that were fitted, with the misfits that they leave.
    pub tried: Vec<(String, f64)>,
    /// Evaluations of the model.
    pub evaluations: u64,
    /// False where it was stopped before it had ended.
    pub complete: bool,
}

/// How thoroughly the value is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// By descents, from a calibration that has not ended.
    Descents,
    /// By a search where the descents leave more than noise.
    Search,
}

/// Looks for the value of the data sheet that keeps the machine from explaining its recordings.
///
/// # Errors
/// A machine that cannot be simulated.
pub fn correct(
    problem: &Problem,
    fit: &Fit,
    settings: &FitSettings,
    depth: Depth,
    mut watch: impl FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Corrected, Error> {
    let held_out = |id: &str| settings.held_out.iter().any(|held| held == id);
    let fitted = problem.with_runs(|run| !held_out(&run.id));
    let x: Vec<f64> = fit.coordinates();
    let mut work = Work {
        problem: &fitted,
        settings,
        // The search might do as well, or the model is as good already: nothing but noise may be left.
        explains: match depth == Depth::Descents || fit.model_is_adequate() {
            true => NOISE,
            false => ADEQUATE,
        },
        evaluations: 0,
        stopped: false,
    };
    let mut ranked = work.ranked(doubts(&fitted)?, &x);
    ranked.truncate(FITTED);
    let mut tried = Vec::new();
    for candidate in ranked {
        if work.left() == 0 {
            break;
        }
        tried.push(work.descend(candidate, &mut watch)?);
    }
    tried.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
    let above = |best: &Trial| best.misfit > NOISE;
    if depth == Depth::Search && tried.first().is_some_and(above) {
        for trial in tried.iter_mut().take(SEARCHED) {
            work.search(trial, &mut watch)?;
        }
        tried.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
    }
    work.decided(problem, tried, &mut watch)
}

/// A value in doubt and the points from which it is fitted.
struct Ranked {
    doubt: Doubt,
    starts: Vec<Vec<f64>>,
    /// The least misfit that the linear model promises.
    promised: f64,
}

/// A value in doubt, fitted with everything else.
struct Trial {
    doubt: Doubt,
    x: Vec<f64>,
    misfit: f64,
}

/// A trial that explains the recordings.
struct Explained {
    doubt: Doubt,
    problem: Problem,
    fit: Fit,
    misfit: f64,
}

struct Work<'a> {
    /// The problem with the runs that are fitted to.
    problem: &'a Problem,
    settings: &'a FitSettings,
    /// The misfit up to which a value explains the recordings.
    explains: f64,
    evaluations: u64,
    stopped: bool,
}

impl Work<'_> {
    /// Evaluations that are left: as many as the search itself was given.
    fn left(&self) -> u64 {
        match self.stopped {
            true => 0,
            false => self.settings.evaluations.saturating_sub(self.evaluations),
        }
    }

    /// The values in doubt that are felt, those that promise to close most first, with their starts.
    fn ranked(&mut self, doubts: Vec<Doubt>, x: &[f64]) -> Vec<Ranked> {
        // The zero of the crank angle is not calibrated: it is known even where another value is wrong.
        let nominal = self.problem.parameters.iter().zip(x);
        let nominal = nominal.map(|(parameter, x)| match parameter.is_crank_angle_offset() {
            true => *x,
            false => 0.0,
        });
        let points = [x.to_vec(), nominal.collect()];
        // Those that stand in the machine file already are looked at together.
        let (there, added): (Vec<Doubt>, Vec<Doubt>) = doubts
            .into_iter()
            .partition(|d| d.tree == self.problem.tree && d.starts == [0.0]);
        let added = added.into_iter().map(|doubt| vec![doubt]);
        let groups = std::iter::once(there).chain(added);
        let mut ranked: Vec<Ranked> = groups
            .filter(|group| !group.is_empty())
            .flat_map(|group| self.looked_at(group, &points))
            .filter(|candidate| !candidate.starts.is_empty())
            .collect();
        ranked.sort_by(|a, b| a.promised.total_cmp(&b.promised));
        ranked
    }

    /// Values with one machine file, each with what it promises at the points.
    fn looked_at(&mut self, group: Vec<Doubt>, points: &[Vec<f64>]) -> Vec<Ranked> {
        let mut problem = self.problem.clone();
        problem.tree = group[0].tree.clone();
        problem
            .parameters
            .extend(group.iter().map(|doubt| doubt.parameter.clone()));
        let likelihood = Likelihood::new(&problem);
        let starts = group[0].starts.clone();
        let mut ranked: Vec<Ranked> = group
            .into_iter()
            .map(|doubt| Ranked {
                doubt,
                starts: Vec::new(),
                promised: f64::INFINITY,
            })
            .collect();
        for point in points {
            let mut best = vec![(f64::INFINITY, 0.0); ranked.len()];
            for start in &starts {
                let mut x = point.clone();
                x.resize(problem.parameters.len(), *start);
                self.evaluations += 1 + optimiser::derivatives(x.len());
                let residuals = DVector::from_vec(likelihood.residuals(&x));
                let (known, doubted) = split(&likelihood.jacobian(&x), point.len());
                let promises = promises(&residuals, known, &doubted);
                for ((best, candidate), promised) in best.iter_mut().zip(&ranked).zip(promises) {
                    let felt = |length: f64| length * candidate.doubt.deviation >= FELT;
                    if let Some((misfit, length)) = promised
                        && felt(length)
                        && misfit < best.0
                    {
                        *best = (misfit, *start);
                    }
                }
            }
            for (candidate, (promised, start)) in ranked.iter_mut().zip(best) {
                if promised.is_finite() {
                    let start = point.iter().copied().chain([start]).collect();
                    candidate.starts.push(start);
                    candidate.promised = candidate.promised.min(promised);
                }
            }
        }
        ranked
    }

    /// Fits a value with everything else, from each of its starts until the noise is reached.
    fn descend(
        &mut self,
        candidate: Ranked,
        watch: &mut impl FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Trial, Error> {
        let added = candidate.doubt.added(self.problem);
        let likelihood = Likelihood::new(&added);
        let mut best: Option<Progress> = None;
        for start in &candidate.starts {
            let reached = best.as_ref().is_some_and(|best| best.misfit() < NOISE);
            let most = self.left().min(DESCENT);
            if most == 0 || reached {
                break;
            }
            let found = {
                let report = &mut self.reporter(watch);
                let change = search::CHANGE;
                optimiser::levenberg_marquardt(&likelihood, start, change, most, report)?
            };
            self.evaluations += found.evaluations;
            if best.as_ref().is_none_or(|best| found.cost < best.cost) {
                best = Some(found);
            }
        }
        let (x, misfit) = match best {
            Some(best) => (best.x.clone(), best.misfit()),
            None => (candidate.starts[0].clone(), f64::INFINITY),
        };
        Ok(Trial {
            doubt: candidate.doubt,
            x,
            misfit,
        })
    }

    /// Searches on from where a descent has ended.
    fn search(
        &mut self,
        trial: &mut Trial,
        watch: &mut impl FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<(), Error> {
        let most = self.left().min(TRIED);
        if most == 0 {
            return Ok(());
        }
        let added = trial.doubt.added(self.problem);
        let seed = self.settings.seed;
        let found = {
            let report = &mut self.reporter(watch);
            search::search(&added, &trial.x, seed, most, report)?
        };
        self.evaluations += found.evaluations;
        if found.misfit() < trial.misfit {
            trial.misfit = found.misfit();
            trial.x = found.x;
        }
        Ok(())
    }

    /// What the trials come to, for the problem with all runs.
    fn decided(
        mut self,
        problem: &Problem,
        tried: Vec<Trial>,
        watch: &mut impl FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Corrected, Error> {
        let misfits = tried
            .iter()
            .map(|t| (t.doubt.parameter.path.clone(), t.misfit));
        let misfits: Vec<(String, f64)> = misfits.collect();
        let mut explained = Vec::new();
        let explains = self.explains;
        for trial in tried.into_iter().filter(|trial| trial.misfit <= explains) {
            let added = trial.doubt.added(problem);
            let fit = self.finished(&added, trial.x, watch)?;
            if fit.model_is_adequate() {
                explained.push(Explained {
                    doubt: trial.doubt,
                    problem: added,
                    misfit: trial.misfit,
                    fit,
                });
            }
        }
        let mut corrected = Corrected {
            fit: None,
            corrections: Vec::new(),
            applied: false,
            tried: misfits,
            evaluations: 0,
            complete: true,
        };
        // A value that may as well be the stated one has only led to a better fit.
        let fitted_otherwise = explained.iter().find(|e| e.holds_nominal());
        if let Some(explained) = fitted_otherwise {
            let mut x = explained.fit.coordinates();
            x.pop();
            let fit = self.finished(problem, x, watch)?;
            if fit.model_is_adequate() {
                corrected.fit = Some((problem.clone(), fit));
            }
        }
        explained.retain(|e| !e.holds_nominal());
        if corrected.fit.is_none() && !self.stopped {
            let count = Likelihood::new(self.problem).count();
            let probabilities = probabilities(&explained, count);
            let mut all: Vec<(Explained, f64)> = explained.into_iter().zip(probabilities).collect();
            all.retain(|(_, probability)| *probability >= RIVAL);
            all.sort_by(|a, b| b.1.total_cmp(&a.1));
            corrected.corrections = all.iter().filter_map(|(e, p)| e.correction(*p)).collect();
            if let Some((first, probability)) = all.into_iter().next()
                && probability >= CLEAR
            {
                corrected.applied = true;
                corrected.fit = Some((first.problem, first.fit));
            }
        }
        corrected.evaluations = self.evaluations;
        corrected.complete = !self.stopped;
        Ok(corrected)
    }

    /// The fit from where a descent has ended, with its intervals.
    fn finished(
        &mut self,
        problem: &Problem,
        start: Vec<f64>,
        watch: &mut impl FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Fit, Error> {
        let settings = FitSettings {
            optimiser: Optimiser::LevenbergMarquardt,
            evaluations: DESCENT,
            start: Some(start),
            ..self.settings.clone()
        };
        let fit = calibrate(problem, &settings, self.reporter(watch))?;
        self.evaluations += fit.evaluations;
        Ok(fit)
    }

    /// Tells where the work stands, with the evaluations of all of it.
    fn reporter<'w>(
        &'w mut self,
        watch: &'w mut impl FnMut(&Progress) -> ControlFlow<()>,
    ) -> impl FnMut(&Progress) -> ControlFlow<()> + 'w {
        move |progress| {
            let answer = watch(&Progress {
                evaluations: self.evaluations + progress.evaluations,
                ..progress.clone()
            });
            self.stopped |= answer.is_break();
            answer
        }
    }
}

impl Explained {
    fn estimate(&self) -> Option<&Estimate> {
        self.fit.estimates.last()
    }

    /// Whether the value may be the stated one, or is not identifiable.
    fn holds_nominal(&self) -> bool {
        let interval = self.estimate().and_then(|e| e.interval);
        let nominal = self.doubt.parameter.nominal;
        match interval {
            Some([low, high]) => self.doubt.stated && low <= nominal && nominal <= high,
            None => true,
        }
    }

    /// The logarithm of its evidence over that of a misfit of 0; residuals are `count`, each of the variance
    /// `excess`.
    fn evidence(&self, count: usize, excess: f64) -> f64 {
        let Some((estimate, [low, high])) = self.estimate().and_then(|e| Some((e, e.interval?)))
        else {
            return f64::NEG_INFINITY;
        };
        let parameter = &estimate.parameter;
        let of = |value: f64| parameter.coordinate(value) / self.doubt.deviation;
        let width = (of(high) - of(low)) / (2.0 * QUANTILE);
        let squares = count as f64 * self.misfit.powi(2) / excess;
        -0.5 * (squares + of(estimate.value).powi(2)) + width.clamp(f64::MIN_POSITIVE, 1.0).ln()
    }

    fn correction(&self, probability: f64) -> Option<Correction> {
        Some(Correction {
            estimate: self.estimate()?.clone(),
            stated: self.doubt.stated,
            probability,
            misfit: self.misfit,
        })
    }
}

/// The probability of each, one of them being right. Where the best leaves more than noise, residuals have
/// that variance.
fn probabilities(explained: &[Explained], count: usize) -> Vec<f64> {
    let least = explained
        .iter()
        .map(|e| e.misfit)
        .fold(f64::INFINITY, f64::min);
    let excess = least.max(1.0).powi(2);
    let evidence: Vec<f64> = explained
        .iter()
        .map(|e| e.evidence(count, excess))
        .collect();
    let greatest = evidence.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = evidence.iter().map(|e| (e - greatest).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}
