//! The search as its user sees it: evaluations, their rate and the misfit.

use crate::progress::Progress as Shown;
use ::calibrate::optimiser::Progress;
use ::calibrate::{Stage, Watcher};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// The progress of the stage that is under way; `cancel` stops the calibration.
pub(crate) struct Bar<'a> {
    cancel: &'a AtomicBool,
    shown: Shown,
}

impl<'a> Bar<'a> {
    pub(crate) fn new(cancel: &'a AtomicBool) -> Self {
        Self {
            cancel,
            shown: Shown::hidden(),
        }
    }
}

impl Watcher for Bar<'_> {
    fn begins(&mut self, stage: Stage, evaluations: u64) {
        let (what, template) = match stage {
            Stage::Fit => (
                "evaluations at most",
                "{spinner} {pos} evaluations of at most {len}, {per_sec}, {elapsed}, {msg}",
            ),
            Stage::DataSheet => (
                "evaluations at most for values of the data sheet",
                "{spinner} the model is wrong: values of the data sheet, {pos} evaluations, {elapsed}, {msg}",
            ),
            Stage::Screen => (
                "evaluations to screen clearances",
                "{spinner} clearances are screened, {pos} evaluations, {elapsed}",
            ),
            Stage::Clearances => (
                "evaluations to fit clearances",
                "{spinner} clearances are fitted, {pos} evaluations, {elapsed}, {msg}",
            ),
            Stage::Relations => return,
        };
        self.shown = Shown::hidden();
        // How many the clearances take follows from the evidence.
        let most = (evaluations > 0).then_some(evaluations);
        self.shown = Shown::new(what, most, template);
    }

    fn progress(&mut self, progress: &Progress) -> ControlFlow<()> {
        self.shown.bar.set_position(progress.evaluations);
        self.shown.say(&format!("misfit {:.3}", progress.misfit()));
        match self.cancel.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    fn ends(&mut self) {
        self.shown = Shown::hidden();
    }
}
