//! What is being tried.

use crate::progress::Progress;
use gap::Stage;

/// The present stage.
pub struct Bar(Progress);

impl Bar {
    pub fn new() -> Self {
        Self(Progress::new(
            "explaining the gap",
            None,
            "{spinner} {elapsed} {msg}",
        ))
    }

    pub fn show(&self, stage: &Stage) {
        let misfit = match stage.misfit.is_finite() {
            true => format!(", misfit {:.2}", stage.misfit),
            false => String::new(),
        };
        self.0.say(&format!("{}{misfit}", stage.words));
    }
}
