//! The search as its user sees it: evaluations, their rate and the misfit; nothing where standard
//! error is no terminal.

use ::calibrate::optimiser::Progress;
use ::calibrate::{Stage, Watcher};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often the clock of the bar is redrawn between two steps.
const TICK: Duration = Duration::from_millis(500);

/// The bar of the stage that is under way; `cancel` stops the calibration.
pub(crate) struct Bar<'a> {
    cancel: &'a AtomicBool,
    bar: ProgressBar,
}

impl<'a> Bar<'a> {
    pub(crate) fn new(cancel: &'a AtomicBool) -> Self {
        Self {
            cancel,
            bar: ProgressBar::hidden(),
        }
    }
}

impl Watcher for Bar<'_> {
    fn begins(&mut self, stage: Stage, evaluations: u64) {
        let template = match stage {
            Stage::Fit => {
                "{spinner} {pos} evaluations of at most {len}, {per_sec}, {elapsed}, misfit {msg}"
            }
            Stage::DataSheet => {
                "{spinner} the model is wrong: values of the data sheet, {pos} evaluations, {elapsed}, misfit {msg}"
            }
            Stage::Screen => "{spinner} clearances are screened, {pos} evaluations, {elapsed}",
            Stage::Clearances => {
                "{spinner} clearances are fitted, {pos} evaluations, {elapsed}, misfit {msg}"
            }
            Stage::Relations => return,
        };
        let target = ProgressDrawTarget::stderr();
        self.bar = ProgressBar::with_draw_target(Some(evaluations), target);
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style);
        }
        self.bar.set_message("–");
        self.bar.enable_steady_tick(TICK);
    }

    fn progress(&mut self, progress: &Progress) -> ControlFlow<()> {
        self.bar.set_position(progress.evaluations);
        self.bar.set_message(format!("{:.3}", progress.misfit()));
        match self.cancel.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    fn ends(&mut self) {
        self.bar.finish_and_clear();
        self.bar = ProgressBar::hidden();
    }
}
