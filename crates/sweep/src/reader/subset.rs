//! The tables of a dataset.

/// The tables of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subset {
    /// The recordings, a row for each window.
    Signals,
    /// The features, a row for each window.
    Features,
    /// The bifurcation diagrams, a file for each.
    Bifurcations,
}

impl Subset {
    /// Its folder in that of the dataset.
    pub fn name(self) -> &'static str {
        match self {
            Self::Signals => "signals",
            Self::Features => "features",
            Self::Bifurcations => "bifurcations",
        }
    }
}
