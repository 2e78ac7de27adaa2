//! The search as its user sees it: evaluations, their rate and the misfit; nothing where standard
//! error is no terminal.

use super::Task;
use crate::Failure;
use ::calibrate::fit::Fit;
use ::calibrate::optimiser::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often the clock of the bar goes on between two steps.
const TICK: Duration = Duration::from_millis(500);

/// Searches the best fit until `cancel` is set. Runs whose crank angle was not recorded are aligned
/// anew with the fitted machine, and fitted again.
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
    let mut spent = 0;
    let outcome = loop {
        let found = ::calibrate::calibrate(&task.problem, &task.settings, |progress: &Progress| {
            bar.set_position(spent + progress.evaluations);
            bar.set_message(format!("{:.3}", progress.misfit()));
            match cancel.load(Ordering::Relaxed) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        let mut fit = match found.map_err(Failure::work) {
            Ok(fit) => fit,
            Err(failure) => break Err(failure),
        };
        spent += fit.evaluations;
        let x: Vec<f64> = fit
            .estimates
            .iter()
            .map(|e| e.parameter.coordinate(e.value))
            .collect();
        match task.align(&x) {
            Ok(true) if fit.complete && spent < task.settings.evaluations => {
                task.settings.start = Some(x);
            }
            Ok(_) => {
                fit.evaluations = spent;
                break Ok(fit);
            }
            Err(failure) => break Err(failure),
        }
    };
    bar.finish_and_clear();
    outcome
}
