//! What can be wrong with a signal.

use thiserror::Error;

/// Why a measure has no value.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Error {
    /// Too few samples for the measure.
    #[error("the signal has {found} samples; at least {needed} are needed")]
    TooShort {
        /// Samples given.
        found: usize,
        /// Samples needed.
        needed: usize,
    },
    /// A sample that is not a number, or infinite.
    #[error("sample {index} is {value}, not a finite number")]
    NotFinite {
        /// Its index.
        index: usize,
        /// What stands there.
        value: f64,
    },
    /// No sample differs from the first.
    #[error("the signal is constant at {value}")]
    Constant {
        /// The value.
        value: f64,
    },
    /// The divergence curve has no straight part that rises.
    #[error("no scaling region: {reason}")]
    NoScalingRegion {
        /// What is missing.
        reason: &'static str,
    },
    /// A setting outside its range.
    #[error("{name} is {value}; it must be from {low} to {high}")]
    Setting {
        /// What the setting is called.
        name: &'static str,
        /// Its value.
        value: usize,
        /// Smallest possible value.
        low: usize,
        /// Largest possible value.
        high: usize,
    },
}

/// Fewest samples that anything is said about.
pub const FEWEST_SAMPLES: usize = 100;

/// The signal's mean and standard deviation, or why nothing can be said about it.
///
/// # Errors
/// Fewer than [`FEWEST_SAMPLES`] samples, a sample that is not finite, or samples that are all equal.
pub fn checked(signal: &[f64]) -> Result<(f64, f64), Error> {
    if signal.len() < FEWEST_SAMPLES {
        return Err(Error::TooShort {
            found: signal.len(),
            needed: FEWEST_SAMPLES,
        });
    }
    if let Some(index) = signal.iter().position(|x| !x.is_finite()) {
        return Err(Error::NotFinite {
            index,
            value: signal[index],
        });
    }
    if signal.iter().all(|x| *x == signal[0]) {
        return Err(Error::Constant { value: signal[0] });
    }
    // Scaled by the largest value, so that no square overflows or vanishes.
    let largest = signal.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let count = signal.len() as f64;
    let mean = signal.iter().map(|x| x / largest).sum::<f64>() / count;
    let variance = signal
        .iter()
        .map(|x| (x / largest - mean).powi(2))
        .sum::<f64>()
        / count;
    Ok((mean * largest, variance.sqrt() * largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_signals_are_refused_with_the_reason() {
        let mut signal: Vec<f64> = (0..200).map(f64::from).collect();
        let (mean, deviation) = checked(&signal).unwrap();
        assert!((mean - 99.5).abs() < 1e-10 && (deviation - 57.734).abs() < 1e-3);
        assert_eq!(
            checked(&signal[..99]),
            Err(Error::TooShort {
                found: 99,
                needed: 100
            })
        );
        assert_eq!(checked(&[2.0; 100]), Err(Error::Constant { value: 2.0 }));
        signal[7] = f64::INFINITY;
        assert_eq!(
            checked(&signal),
            Err(Error::NotFinite {
                index: 7,
                value: f64::INFINITY
            })
        );
    }
}
