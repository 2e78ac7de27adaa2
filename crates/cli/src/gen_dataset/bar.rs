//! The progress of a sweep.

use crate::output::warn;
use crate::progress::Progress;

/// Cases done: rate and time left.
#[derive(Default)]
pub(crate) struct Bar {
    progress: Option<Progress>,
    failed: u64,
}

impl sweep::dataset::Progress for Bar {
    fn begins(&mut self, cases: u64, finished: u64) {
        self.show(cases, finished, "cases");
    }

    fn warning(&mut self, text: &str) {
        warn(&[text.to_owned()]);
    }

    fn case_done(&mut self, _case: u64, failed: bool) {
        let Some(progress) = &self.progress else {
            return;
        };
        progress.bar.inc(1);
        if failed {
            self.failed += 1;
            progress.say(&format!("{} failed", self.failed));
        }
    }

    fn diagrams_begin(&mut self, values: u64, finished: u64) {
        self.show(values, finished, "values of bifurcation diagrams");
    }

    fn values_done(&mut self, values: u64) {
        if let Some(progress) = &self.progress {
            progress.bar.inc(values);
        }
    }
}

impl Bar {
    fn show(&mut self, total: u64, finished: u64, what: &str) {
        // The line before is taken off first.
        self.progress = None;
        let template =
            format!("{{bar:40}} {{pos}}/{{len}} {what}  {{per_sec}}  {{eta}} left  {{msg}}");
        let progress = Progress::new(what, Some(total), &template);
        progress.bar.set_position(finished);
        progress.bar.reset_eta();
        self.progress = Some(progress);
    }
}
