//! What predictions cost, in steps of the integrator, and which of them are known from before.
//! Steps are a measure of time that is the same on every computer.

use crate::checkpoint::Checkpoint;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Counts the steps of all predictions of a problem. Copies count together.
#[derive(Clone, Default)]
pub struct Meter {
    steps: Arc<AtomicU64>,
    checkpoint: Option<Arc<Checkpoint>>,
}

impl Meter {
    /// One that keeps what is evaluated, and evaluates nothing twice.
    pub fn with_checkpoint(checkpoint: Checkpoint) -> Self {
        Self {
            checkpoint: Some(Arc::new(checkpoint)),
            ..Self::default()
        }
    }

    pub(crate) fn add(&self, steps: u64) {
        self.steps.fetch_add(steps, Ordering::Relaxed);
    }

    /// Steps so far; one with eight tangents counts as seven.
    pub fn steps(&self) -> u64 {
        self.steps.load(Ordering::Relaxed)
    }

    /// The numbers that `work` gives for this input, or gave before.
    pub(crate) fn once(&self, input: &dyn fmt::Debug, work: impl FnOnce() -> Vec<f64>) -> Vec<f64> {
        self.once_each(&[input], |_| vec![work()]).concat()
    }

    /// The same for each of several inputs: `work` gives those of the indices that are not known from before.
    pub(crate) fn once_each(
        &self,
        inputs: &[impl fmt::Debug],
        work: impl FnOnce(&[usize]) -> Vec<Vec<f64>>,
    ) -> Vec<Vec<f64>> {
        match &self.checkpoint {
            Some(checkpoint) => checkpoint.once_each(inputs, work),
            None => work(&(0..inputs.len()).collect::<Vec<_>>()),
        }
    }
}

/// Problems are compared without their cost.
impl fmt::Debug for Meter {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("Meter")
    }
}
