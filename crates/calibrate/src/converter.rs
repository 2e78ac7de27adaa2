//! The converter of a channel as its recorded values show it.
//!
//! Recorded values lie on a lattice, whose step is the converter's. Its range is not identifiable: a
//! record that stays within a range says nothing of how much further that goes.

use crate::observation::Run;
use serde::{Deserialize, Serialize};
use signal::quantisation::quantisation_step;
use std::f64::consts::TAU;
use std::fmt;

/// Bits of a converter whose range is not known. Recordings are stored in single precision, which has as many.
/// A lattice that is seen in them has no more, and one of as many is stored without loss.
pub const ASSUMED_BITS: u32 = f32::MANTISSA_DIGITS;
/// Relative difference below which two steps are one.
const SAME_STEP: f64 = 1e-3;

/// The converter of a channel, values in the channel's SI unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "converter", rename_all = "snake_case")]
pub enum Converter {
    /// All runs have one step. The range is not identifiable: that of [`ASSUMED_BITS`] is assumed, which
    /// no machine exceeds that the converter could record.
    RangeAssumed {
        /// Step of the recorded values.
        resolution: f64,
        /// Bits that the recorded values need with this step: the true number is no less.
        bits_needed: u32,
        /// Bits over ± the range, assumed.
        bits: u32,
        /// The range, assumed.
        range: f64,
    },
    /// The step differs between runs: the recorder sets its range to each record.
    RangePerRun {
        /// The coarsest step.
        resolution: f64,
        /// The finest step.
        finest: f64,
        /// Bits that the recorded values need: of the run that needs most.
        bits: u32,
    },
    /// An encoder divides the turn.
    Encoder {
        /// Step of the angle, rad.
        resolution: f64,
        /// Bits over the turn.
        bits: u32,
    },
    /// Neither step nor range is identifiable.
    Unknown {
        /// Why.
        converter_reason: String,
    },
}

impl Converter {
    /// That of a channel whose samples these are, by run.
    pub(crate) fn of_samples(runs: &[&[f64]]) -> Self {
        let steps: Option<Vec<f64>> = runs.iter().map(|x| quantisation_step(x)).collect();
        let Some(steps) = steps.filter(|steps| !steps.is_empty()) else {
            return Self::unknown(
                "the recorded values lie on no lattice that is seen in single precision",
            );
        };
        let resolution = steps.iter().copied().fold(0.0, f64::max);
        let finest = steps.iter().copied().fold(f64::INFINITY, f64::min);
        let needed = runs
            .iter()
            .zip(&steps)
            .map(|(x, step)| bits_needed(x, *step));
        let bits_needed = needed.max().unwrap_or(0);
        match resolution / finest - 1.0 < SAME_STEP {
            true => Self::RangeAssumed {
                resolution,
                bits_needed,
                bits: ASSUMED_BITS,
                range: f64::from(ASSUMED_BITS - 1).exp2() * resolution,
            },
            false => Self::RangePerRun {
                resolution,
                finest,
                bits: bits_needed,
            },
        }
    }

    /// That of the encoder which gave these runs their crank angle.
    pub(crate) fn of_encoder<'a>(runs: impl Iterator<Item = &'a Run>) -> Self {
        let steps = runs.filter_map(|run| quantisation_step(run.crank_angle.as_ref()?));
        let step = steps.min_by(f64::total_cmp);
        let encoder = step.and_then(|resolution| {
            let bits = whole_bits(TAU, resolution)?;
            Some(Self::Encoder { resolution, bits })
        });
        encoder.unwrap_or_else(|| {
            Self::unknown("its steps are no whole power of two to the turn, or too fine to be seen")
        })
    }

    fn unknown(reason: &str) -> Self {
        Self::Unknown {
            converter_reason: reason.to_owned(),
        }
    }
}

/// The least bits over ± a range that covers the samples in steps of `step`.
fn bits_needed(samples: &[f64], step: f64) -> u32 {
    let largest = samples.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let codes = (2.0 * largest / step).max(1.0);
    // A lattice that is seen has fewer codes than single precision numbers.
    codes.log2().ceil() as u32
}

/// The bits with which a converter divides `span` into steps of `resolution`; none where they are no
/// whole number from 1 to [`ASSUMED_BITS`].
pub(crate) fn whole_bits(span: f64, resolution: f64) -> Option<u32> {
    let bits = (span / resolution).log2().round();
    let exact = (span / resolution / bits.exp2() - 1.0).abs() < SAME_STEP;
    (exact && bits >= 1.0 && bits <= f64::from(ASSUMED_BITS)).then_some(bits as u32)
}

/// What is known of it, in words.
impl fmt::Display for Converter {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::RangeAssumed {
                resolution,
                bits_needed,
                bits,
                range,
            } => write!(
                f,
                "steps of {resolution:.3e}, {bits_needed} bits or more; its range is not identifiable, \
             {bits} bits are assumed, or {range:.3e}"
            ),
            Self::RangePerRun {
                resolution,
                finest,
                bits,
            } => write!(
                f,
                "steps of {finest:.3e} to {resolution:.3e}, {bits} bits over a range set to each run"
            ),
            Self::Encoder { bits, .. } => write!(f, "{bits} bits to the turn"),
            Self::Unknown { converter_reason } => write!(f, "no bits: {converter_reason}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave of the amplitude, recorded in steps.
    fn recorded(amplitude: f64, step: f64) -> Vec<f64> {
        let of = |i: i32| amplitude * (0.013 * f64::from(i)).sin();
        let rounded = |x: f64| f64::from(((x / step).round() * step) as f32);
        (0..10_000).map(|i| rounded(of(i))).collect()
    }

    #[test]
    fn one_step_tells_nothing_of_the_range() {
        // 1 to 2 steps of each whole power of two, and every odd word length between.
        for amplitude in [20.0, 100.0, 700.0, 3000.0] {
            let samples = recorded(amplitude, 0.0625);
            let Converter::RangeAssumed {
                resolution,
                bits_needed,
                bits,
                range,
            } = Converter::of_samples(&[&samples])
            else {
                panic!("{amplitude}");
            };
            assert!((resolution / 0.0625 - 1.0).abs() < 1e-4, "{resolution}");
            assert!((2.0 * range / f64::from(bits).exp2() / resolution - 1.0).abs() < 1e-12);
            assert!(f64::from(bits_needed).exp2() * resolution >= 2.0 * amplitude);
            assert!(f64::from(bits_needed).exp2() * resolution < 4.1 * amplitude);
            // Whatever a converter of this step can record is within the range.
            assert!(range >= f64::from(ASSUMED_BITS - 1).exp2() * resolution);
        }
    }

    #[test]
    fn steps_that_follow_the_signal_are_a_range_set_to_each_run() {
        let runs = [
            recorded(400.0, 512.0 / 32768.0),
            recorded(900.0, 1024.0 / 32768.0),
        ];
        let runs: Vec<&[f64]> = runs.iter().map(Vec::as_slice).collect();
        let Converter::RangePerRun {
            resolution,
            finest,
            bits,
        } = Converter::of_samples(&runs)
        else {
            panic!("one step");
        };
        assert_eq!(bits, 16);
        assert!((resolution / finest / 2.0 - 1.0).abs() < 1e-3);
    }
}
