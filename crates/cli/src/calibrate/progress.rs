//! The search as its user sees it: a bar with the misfit, and Ctrl-C, which keeps the best so far.

use crate::Failure;
use ::calibrate::Problem;
use ::calibrate::fit::{Fit, FitSettings};
use ::calibrate::optimiser::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Searches the best fit.
///
/// # Errors
/// Where the machine cannot be simulated.
pub fn search(problem: &Problem, settings: &FitSettings) -> Result<Fit, Failure> {
    let cancel = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancel);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).map_err(Failure::work)?;
    let bar = ProgressBar::new(settings.evaluations);
    bar.set_draw_target(ProgressDrawTarget::stderr());
    if let Ok(style) =
        ProgressStyle::with_template("{wide_bar} {pos} evaluations, {elapsed}, misfit {msg}")
    {
        bar.set_style(style);
    }
    let fit = ::calibrate::calibrate(problem, settings, |progress: &Progress| {
        bar.set_position(progress.evaluations);
        bar.set_message(format!("{:.3}", progress.misfit()));
        if cancel.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    bar.finish_and_clear();
    fit.map_err(Failure::work)
}
