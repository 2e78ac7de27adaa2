//! The process that holds a file.

/// The process that holds a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::dataset) enum Holder {
    /// It runs.
    AtWork,
    /// It has ended.
    Ended,
    /// The storage has no locks.
    Unknown,
}
