//! Why a calibration cannot be made.

use std::path::{Path, PathBuf};

/// Why a calibration cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The machine file, a path or a value of a run.
    #[error(transparent)]
    Input(#[from] input::Error),
    /// A channel cannot be analysed.
    #[error("run {run}: channel {channel}: {source}")]
    Signal {
        /// The run.
        run: String,
        /// The channel.
        channel: String,
        /// What is wrong with it.
        source: signal::Error,
    },
    /// A run holds nothing that the model predicts.
    #[error(
        "run {run} has no channel that the model predicts; its channels are {found}, and those that can be used are {known}"
    )]
    NoChannel {
        /// The run.
        run: String,
        /// What it has.
        found: String,
        /// What the machine's sensors could give.
        known: String,
    },
    /// A channel that is noise alone.
    #[error(
        "run {run}: channel {channel} does not repeat with the crank: no order stands out of its noise"
    )]
    OnlyNoise {
        /// The run.
        run: String,
        /// The channel.
        channel: String,
    },
    /// A channel of a sensor that records nothing.
    #[error(
        "run {run}: channel {channel} has the value {value} in each of its {count} samples: its sensor or cable is dead; leave the run \
         or the channel out"
    )]
    Dead {
        /// The run.
        run: String,
        /// The channel.
        channel: String,
        /// The value, SI.
        value: f64,
        /// Samples.
        count: usize,
    },
    /// A channel that was cut off by its range.
    #[error(
        "run {run}: channel {channel} is clipped: {count} samples in a row stand at its {limit} value {value}"
    )]
    Clipped {
        /// The run.
        run: String,
        /// The channel.
        channel: String,
        /// Longest stretch at the limit, samples.
        count: usize,
        /// Which of its values the limit is: `greatest` or `least`.
        limit: &'static str,
        /// The limit, SI.
        value: f64,
    },
    /// The recorded crank angle and the stated speed contradict each other.
    #[error(
        "run {run}: the speed is stated as {stated:.1} rpm, but the recording turns at {measured:.1} rpm"
    )]
    Speed {
        /// The run.
        run: String,
        /// What the bundle says, rpm.
        stated: f64,
        /// What the recording says, rpm.
        measured: f64,
    },
    /// A parameter whose value cannot be fitted.
    #[error("{path} cannot be fitted: {reason}")]
    Parameter {
        /// Its path in the machine file.
        path: String,
        /// Why.
        reason: String,
    },
    /// The machine cannot be simulated anywhere near its nominal parameters.
    #[error("run {run} cannot be simulated with the nominal parameters: {source}")]
    Simulation {
        /// The run.
        run: String,
        /// What happened.
        source: simulate::Error,
    },
    /// The optimiser cannot start: bounds that contradict each other.
    #[error("the search cannot go on: {0}")]
    Optimiser(String),
    /// Nothing to fit, or nothing to fit it to.
    #[error("{0}")]
    Nothing(&'static str),
    /// A run that cannot be used, or contradicts the machine.
    #[error("run {run}: {reason} (--leave-out {run} goes on without it)")]
    Unusable {
        /// The run.
        run: String,
        /// What is wrong with it.
        reason: String,
    },
    /// What is asked for cannot be done.
    #[error("{0}")]
    Refused(String),
    /// A file that cannot be used or written.
    #[error("{}: {reason}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A file of results that cannot be written.
    #[error(transparent)]
    Write(#[from] recordings::Error),
}

impl Error {
    /// A run that cannot be used for this reason, which may begin with the run's name.
    pub fn unusable(run: &str, reason: impl ToString) -> Self {
        let reason = reason.to_string();
        let named = format!("run {run}: ");
        Self::Unusable {
            run: run.to_owned(),
            reason: reason.strip_prefix(&named).unwrap_or(&reason).to_owned(),
        }
    }

    /// A file that cannot be used or written.
    pub fn file(path: &Path, reason: impl ToString) -> Self {
        Self::File {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }
}
