//! The progress bar of a sweep.

use super::summary::warn;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use sweep::dataset::Progress;

/// The bar on standard error: rate and time left; nothing where that is no terminal.
#[derive(Default)]
pub(crate) struct Bar {
    bar: Option<ProgressBar>,
    failed: u64,
}

impl Progress for Bar {
    fn begins(&mut self, cases: u64, finished: u64) {
        self.show(cases, finished, "cases");
    }

    fn warning(&mut self, text: &str) {
        warn(&[text.to_owned()]);
    }

    fn case_done(&mut self, _case: u64, failed: bool) {
        let Some(bar) = &self.bar else { return };
        bar.inc(1);
        if failed {
            self.failed += 1;
            bar.set_message(format!("{} failed", self.failed));
        }
    }

    fn diagrams_begin(&mut self, values: u64, finished: u64) {
        self.finish();
        self.show(values, finished, "values of bifurcation diagrams");
    }

    fn values_done(&mut self, values: u64) {
        if let Some(bar) = &self.bar {
            bar.inc(values);
        }
    }
}

impl Bar {
    fn show(&mut self, total: u64, finished: u64, what: &str) {
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
        let template =
            format!("{{bar:40}} {{pos}}/{{len}} {what}  {{per_sec}}  {{eta}} left  {{msg}}");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style);
        }
        bar.set_position(finished);
        bar.reset_eta();
        self.bar = Some(bar);
    }

    /// Takes it off the terminal.
    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
