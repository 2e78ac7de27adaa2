//! The search as its user sees it: evaluations, their rate and the misfit; nothing where standard
//! error is no terminal.

use super::Task;
use crate::Failure;
use ::calibrate::fit::{Fit, FitSettings, Optimiser};
use ::calibrate::optimiser::Progress;
use ::calibrate::{Corrected, Depth};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often the clock of the bar goes on between two steps.
const TICK: Duration = Duration::from_millis(500);

/// What is shown of the search, and of the look at the data sheet that may follow.
const FITTING: &str =
    "{spinner} {pos} evaluations of at most {len}, {per_sec}, {elapsed}, misfit {msg}";
const CORRECTING: &str = "{spinner} the model is wrong: values of the data sheet, {pos} evaluations, {elapsed}, misfit {msg}";

/// Local fits after each of which runs without a zero of their crank angle are aligned anew, before
/// the search proper, which a wrong zero would send far away.
const ALIGNMENTS: usize = 3;

/// What has come of a task.
pub struct Searched {
    /// The fit.
    pub fit: Fit,
    /// What was looked for in the data sheet; none where no more than noise is left at once.
    pub corrected: Option<Corrected>,
    /// Evaluations of the model.
    pub evaluations: u64,
}

/// Searches the best fit until `cancel` is set, and where that leaves more than noise the value of the data
/// sheet that is wrong. By default that is looked for as soon as the first descent has ended, before the search
/// goes on: what both evaluate is in the checkpoint.
///
/// # Errors
/// Where the machine cannot be simulated.
pub fn search(task: &mut Task, cancel: &AtomicBool) -> Result<Searched, Failure> {
    let mut spent = 0;
    if task.settings.optimiser == Optimiser::Default {
        let first = fitted(task, Optimiser::FirstDescent, cancel)?;
        let searched = looked_up(task, first, Depth::Descents, cancel)?;
        let ended = !searched.fit.complete;
        let corrected = searched.corrected.as_ref();
        if ended || corrected.is_some_and(|c| c.fit.is_some() || !c.corrections.is_empty()) {
            return Ok(searched);
        }
        spent = corrected.map_or(0, |corrected| corrected.evaluations);
    }
    let fit = fitted(task, task.settings.optimiser, cancel)?;
    let mut searched = looked_up(task, fit, Depth::Search, cancel)?;
    searched.evaluations += spent;
    Ok(searched)
}

fn fitted(task: &mut Task, optimiser: Optimiser, cancel: &AtomicBool) -> Result<Fit, Failure> {
    let bar = bar(task.settings.evaluations, FITTING);
    let found = aligned(task, optimiser, cancel, &bar);
    bar.finish_and_clear();
    found
}

/// A fit with what comes of the data sheet where it does not explain the recordings.
fn looked_up(
    task: &Task,
    mut fit: Fit,
    depth: Depth,
    cancel: &AtomicBool,
) -> Result<Searched, Failure> {
    let mut evaluations = fit.evaluations;
    let mut corrected = None;
    if fit.complete && !fit.is_at_noise() {
        let found = correct(task, &fit, depth, cancel)?;
        evaluations += found.evaluations;
        fit.complete &= found.complete;
        corrected = Some(found);
    }
    Ok(Searched {
        fit,
        corrected,
        evaluations,
    })
}

/// Looks for the value of the data sheet that keeps the model from explaining the recordings, until `cancel`
/// is set.
fn correct(
    task: &Task,
    fit: &Fit,
    depth: Depth,
    cancel: &AtomicBool,
) -> Result<Corrected, Failure> {
    let bar = bar(task.settings.evaluations, CORRECTING);
    let watch = |progress: &Progress| told(&bar, 0, cancel, progress);
    let corrected = ::calibrate::correct(&task.problem, fit, &task.settings, depth, watch);
    bar.finish_and_clear();
    corrected.map_err(Failure::work)
}

fn bar(evaluations: u64, template: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(evaluations), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message("–");
    bar.enable_steady_tick(TICK);
    bar
}

/// Shows the best so far, and says whether to go on.
fn told(
    bar: &ProgressBar,
    spent: u64,
    cancel: &AtomicBool,
    progress: &Progress,
) -> ControlFlow<()> {
    bar.set_position(spent + progress.evaluations);
    bar.set_message(format!("{:.3}", progress.misfit()));
    match cancel.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    }
}

fn aligned(
    task: &mut Task,
    optimiser: Optimiser,
    cancel: &AtomicBool,
    bar: &ProgressBar,
) -> Result<Fit, Failure> {
    let mut settings = task.settings.clone();
    settings.optimiser = Optimiser::LevenbergMarquardt;
    let mut spent = 0;
    let rounds = match task.zeroed.contains(&false) {
        true => ALIGNMENTS,
        false => 0,
    };
    for _ in 0..rounds {
        let fit = fit(task, &settings, cancel, bar, spent)?;
        spent = fit.evaluations;
        if !fit.complete {
            return Ok(fit);
        }
        let x: Vec<f64> = fit
            .estimates
            .iter()
            .map(|e| e.parameter.coordinate(e.value))
            .collect();
        let moved = task.align(&x)?;
        settings.start = Some(x);
        if !moved {
            break;
        }
    }
    settings.optimiser = optimiser;
    fit(task, &settings, cancel, bar, spent)
}

/// One fit, after `spent` evaluations.
fn fit(
    task: &Task,
    settings: &FitSettings,
    cancel: &AtomicBool,
    bar: &ProgressBar,
    spent: u64,
) -> Result<Fit, Failure> {
    let watch = |progress: &Progress| told(bar, spent, cancel, progress);
    let mut fit = ::calibrate::calibrate(&task.problem, settings, watch).map_err(Failure::work)?;
    fit.evaluations += spent;
    Ok(fit)
}
