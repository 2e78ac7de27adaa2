//! What can be wrong with a signal.

/// Why a signal could not be analysed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// There are not enough samples.
    #[error("{got} samples, but at least {needed} are needed")]
    TooFewSamples {
        /// Samples that the method needs.
        needed: usize,
        /// Samples that were given.
        got: usize,
    },
    /// Two things that belong together differ in length.
    #[error("{what}: {got} values where {expected} belong")]
    LengthMismatch {
        /// What has the wrong length.
        what: &'static str,
        /// Its length.
        got: usize,
        /// The length it should have.
        expected: usize,
    },
    /// A sample is infinite or not a number.
    #[error("sample {index} is not a finite number")]
    NotFinite {
        /// Where it stands.
        index: usize,
    },
    /// A parameter lies outside its range.
    #[error("{what} is {}, but must be {allowed}", rounded(*value))]
    OutOfRange {
        /// The parameter, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The range in words.
        allowed: &'static str,
    },
    /// There is no fluctuation whose shape could be determined.
    #[error("the signal does not fluctuate")]
    NoFluctuation,
    /// The crank angle runs backwards or stands still.
    #[error("the crank angle does not increase at sample {index}: it changes by {step_rad} rad")]
    AngleNotIncreasing {
        /// The sample at which the angle is not above the one before.
        index: usize,
        /// Change from the sample before, rad.
        step_rad: f64,
    },
    /// A tacho without two pulses.
    #[error("an angle needs two pulses of a tacho, and there are {got}")]
    TooFewPulses {
        /// Pulses found.
        got: usize,
    },
    /// The recording does not hold enough whole revolutions.
    #[error("{got:.3} revolutions, but at least {needed} are needed")]
    TooFewRevolutions {
        /// Whole revolutions that the method needs.
        needed: usize,
        /// Revolutions in the recording.
        got: f64,
    },
}

/// Checks that `value` is finite and above zero.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::OutOfRange {
        what,
        value,
        allowed: "finite and above 0",
    })
}

/// A value to six digits: more would say nothing in a sentence.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
