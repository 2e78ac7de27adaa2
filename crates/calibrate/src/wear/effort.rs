//! What an estimation has cost so far, and who may stop it.

use crate::optimiser::Progress;
use crate::stages::{Stage, Watcher};
use std::ops::ControlFlow;

/// An estimation under way.
pub(super) struct Effort<'w> {
    watcher: &'w mut dyn Watcher,
    /// Evaluations of the model, all runs being one.
    pub spent: u64,
    /// Whether the watcher has stopped it.
    pub stopped: bool,
    /// Where the best fit of lines stands, as its watcher sees it.
    best: Progress,
}

impl<'w> Effort<'w> {
    /// Nothing spent yet.
    pub fn new(watcher: &'w mut dyn Watcher) -> Self {
        Self {
            watcher,
            spent: 0,
            stopped: false,
            best: Progress {
                x: Vec::new(),
                cost: f64::INFINITY,
                count: 1,
                evaluations: 0,
            },
        }
    }

    /// A stage begins.
    pub fn begins(&mut self, stage: Stage) {
        self.watcher.begins(stage, 0);
    }

    /// The stage has ended.
    pub fn ends(&mut self) {
        self.watcher.ends();
    }

    /// Takes note of evaluations, and returns whether to go on.
    pub fn evaluated(&mut self, count: u64) -> bool {
        self.spent += count;
        self.shown(0).is_continue()
    }

    /// Shows how far a descent has come.
    pub fn shown(&mut self, evaluations: u64) -> ControlFlow<()> {
        self.best.evaluations = self.spent + evaluations;
        let answer = self.watcher.progress(&self.best);
        self.stopped |= answer.is_break();
        match self.stopped {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    /// Takes note of the misfit of a fit of lines.
    pub fn fitted(&mut self, misfit: f64) {
        if misfit < self.best.misfit() {
            (self.best.cost, self.best.count) = (0.5 * misfit.powi(2), 1);
        }
    }
}
