//! What can go wrong.

/// Why a gap cannot be explained.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A machine file that is none.
    #[error(transparent)]
    Machine(#[from] input::Error),
    /// A model that cannot be fitted.
    #[error(transparent)]
    Fit(#[from] calibrate::Error),
    /// A list of effects that is none.
    #[error("effects: found something else than a list of effects")]
    Effects,
    /// Stopped by the user.
    #[error("stopped before an explanation was found")]
    Stopped,
}
