//! Progress of a run.

/// Receives the progress of a sweep, on the thread that writes.
pub trait Progress {
    /// Cases of the sweep, and how many of them were finished before.
    fn begins(&mut self, _cases: u64, _finished: u64) {}
    /// Something is wrong with what was there before.
    fn warning(&mut self, _text: &str) {}
    /// A case is done.
    fn case_done(&mut self, _case: u64, _failed: bool) {}
    /// Values of all bifurcation diagrams, and how many of them were finished before.
    fn diagrams_begin(&mut self, _values: u64, _finished: u64) {}
    /// So many more values are done.
    fn values_done(&mut self, _values: u64) {}
}

/// Ignores the progress.
impl Progress for () {}
