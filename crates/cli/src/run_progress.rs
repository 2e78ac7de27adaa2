//! How far one long run has come, on standard error.

use std::time::{Duration, Instant};

/// Time between two lines: a run that is shorter prints none.
const PAUSE: Duration = Duration::from_secs(5);

/// Tells now and then how far a run has come.
pub(crate) struct Progress {
    told: Instant,
}

impl Progress {
    /// At the beginning of a run.
    pub fn new() -> Self {
        let told = Instant::now();
        Self { told }
    }

    /// So large a share is done.
    pub fn tell(&mut self, share: f64) {
        if self.told.elapsed() >= PAUSE {
            self.told = Instant::now();
            eprintln!("{:.0} % simulated", 100.0 * share);
        }
    }
}
