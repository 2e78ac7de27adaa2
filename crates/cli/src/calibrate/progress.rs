//! The search as its user sees it: evaluations, their rate and the misfit; nothing where standard
//! error is no terminal.

use super::Task;
use crate::Failure;
use ::calibrate::fit::{Fit, FitSettings, Optimiser};
use ::calibrate::optimiser::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often the clock of the bar goes on between two steps.
const TICK: Duration = Duration::from_millis(500);

/// Local fits after each of which runs without a zero of their crank angle are aligned anew, before
/// the search proper, which a wrong zero would send far away.
const ALIGNMENTS: usize = 3;

/// Searches the best fit until `cancel` is set.
///
/// # Errors
/// Where the machine cannot be simulated.
pub fn search(task: &mut Task, cancel: &AtomicBool) -> Result<Fit, Failure> {
    let bar = ProgressBar::with_draw_target(
        Some(task.settings.evaluations),
        ProgressDrawTarget::stderr(),
    );
    let template =
        "{spinner} {pos} evaluations of at most {len}, {per_sec}, {elapsed}, misfit {msg}";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message("–");
    bar.enable_steady_tick(TICK);
    let found = aligned(task, cancel, &bar);
    bar.finish_and_clear();
    found
}

fn aligned(task: &mut Task, cancel: &AtomicBool, bar: &ProgressBar) -> Result<Fit, Failure> {
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
    settings.optimiser = task.settings.optimiser;
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
    let watch = |progress: &Progress| {
        bar.set_position(spent + progress.evaluations);
        bar.set_message(format!("{:.3}", progress.misfit()));
        match cancel.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    };
    let mut fit = ::calibrate::calibrate(&task.problem, settings, watch).map_err(Failure::work)?;
    fit.evaluations += spent;
    Ok(fit)
}
