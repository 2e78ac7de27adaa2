//! What can go wrong.

/// Why a gap cannot be explained.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An invalid machine file.
    #[error(transparent)]
    Machine(#[from] input::Error),
    /// A model that cannot be fitted.
    #[error(transparent)]
    Fit(#[from] calibrate::Error),
    /// A bundle, a machine or settings that cannot be used.
    #[error(transparent)]
    Input(calibrate::Error),
    /// A file that cannot be written.
    #[error(transparent)]
    Write(#[from] recordings::Error),
    /// Results that are no JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// `effects` is not a list.
    #[error("effects: found something else than a list of effects")]
    Effects,
    /// A file of finished work that cannot be read or written.
    #[error("{path}: {source}", path = path.display())]
    Journal {
        /// The file.
        path: std::path::PathBuf,
        /// What is wrong with it.
        source: std::io::Error,
    },
    /// A machine that cannot be simulated with any parameters that were tried.
    #[error("the machine cannot be simulated near its nominal parameters")]
    Nothing,
    /// Stopped by the user.
    #[error("stopped before an explanation was found; the same command goes on from there")]
    Stopped,
}

/// What a fit found; none where it led to a machine that cannot be simulated.
pub(crate) fn possible<T>(fit: Result<T, Error>) -> Result<Option<T>, Error> {
    match fit {
        Err(Error::Fit(_)) => Ok(None),
        found => found.map(Some),
    }
}
