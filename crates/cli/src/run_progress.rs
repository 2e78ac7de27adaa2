//! How far one long run has come, on standard error.

use std::time::{Duration, Instant};

/// Time between two lines: a run that is shorter prints none.
const PAUSE: Duration = Duration::from_secs(5);

/// Tells now and then how far a run has come.
pub(crate) struct Progress {
    shown: Instant,
}

impl Progress {
    /// At the beginning of a run.
    pub fn new() -> Self {
        let shown = Instant::now();
        Self { shown }
    }

    /// So large a share is done.
    pub fn show(&mut self, share: f64) {
        if self.shown.elapsed() >= PAUSE {
            self.shown = Instant::now();
            eprintln!("{:.0} % simulated", 100.0 * share);
        }
    }
}
