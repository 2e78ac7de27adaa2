//! What is being tried, on a terminal.

use gap::Stage;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::Duration;

/// How often the clock is redrawn between two stages.
const TICK: Duration = Duration::from_millis(500);

/// A line with the present stage; nothing if standard error is no terminal.
pub struct Bar(ProgressBar);

impl Bar {
    pub fn new() -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(TICK);
        Self(bar)
    }

    pub fn show(&self, stage: &Stage) {
        let misfit = match stage.misfit.is_finite() {
            true => format!(", misfit {:.2}", stage.misfit),
            false => String::new(),
        };
        let words = format!("{}{misfit}", stage.words);
        self.0.set_message(crate::output::harmless(&words));
    }

    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}
