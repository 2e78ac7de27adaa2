//! What can go wrong in reading a dataset for what it shows.

/// Why a dataset cannot be studied.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The dataset cannot be read.
    #[error(transparent)]
    Dataset(#[from] sweep::reader::Error),
    /// A recording whose crank angle is not that of a turning crank.
    #[error("{place}, {case_id}: {error}")]
    Recording {
        /// The table and the row.
        place: String,
        /// The case.
        case_id: String,
        /// What is wrong with it.
        error: signal::Error,
    },
    /// A recording that cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] signal::Error),
    /// A case that cannot be simulated again.
    #[error("{case_id}: {reason}")]
    Motion {
        /// The case.
        case_id: String,
        /// Why not.
        reason: String,
    },
}

impl Error {
    /// Whether the input is wrong; else the work failed.
    pub fn is_input(&self) -> bool {
        match self {
            Self::Dataset(error) => error.is_input(),
            Self::Recording { .. } => true,
            Self::Analysis(_) | Self::Motion { .. } => false,
        }
    }
}
