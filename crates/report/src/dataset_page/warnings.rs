//! What is doubtful about cases that have data.

/// Most warnings that the page shows.
const MOST_WARNINGS: usize = 20;

/// Something doubtful about a case.
#[derive(Clone, Debug)]
pub struct CaseWarning {
    /// Its number in the sweep.
    pub case_id: String,
    /// What it is, and what to do.
    pub warning: String,
}

/// Those of `all` that are shown.
pub(super) fn shown(all: &[CaseWarning]) -> &[CaseWarning] {
    &all[..all.len().min(MOST_WARNINGS)]
}
