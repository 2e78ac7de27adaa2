//! Anti-aliased decimation by an integer factor.

use crate::error::Error;
use crate::kaiser::{self, HALF_WIDTH, LANES};
use scalar::Scalar;

/// Low-pass and decimation in one: a symmetric FIR filter evaluated only where an output is due.
///
/// - Pass band: to 0.8 of the output's Nyquist frequency, gain 1 within 1e-4; a constant passes
///   exactly.
/// - Stop band: from 1.2 of it, −80 dB or better. Everything that would alias into the pass band
///   lies there; what aliases above the pass band is not suppressed fully.
/// - Delay: none. Each output is centred on its input, for which the caller supplies
///   [`half_length`](Self::half_length) inputs before the first and after the last.
#[derive(Clone, Debug)]
pub struct Decimator {
    factor: usize,
    /// From one end to the other, which are alike.
    taps: Vec<f64>,
}

impl Decimator {
    /// A decimator by `factor`; 1 passes its input through.
    ///
    /// # Errors
    /// A factor of 0.
    pub fn new(factor: usize) -> Result<Self, Error> {
        if factor == 0 {
            return Err(Error::OutOfRange {
                what: "decimation factor",
                value: 0.0,
                allowed: "1 or more",
            });
        }
        let reach = if factor == 1 { 0 } else { HALF_WIDTH * factor };
        let side: Vec<f64> = (0..=reach)
            .map(|i| kaiser::low_pass(i as f64 / factor as f64))
            .collect();
        let gain = 2.0 * side.iter().sum::<f64>() - side[0];
        let taps = side[1..].iter().rev().chain(&side);
        Ok(Self {
            factor,
            taps: taps.map(|tap| tap / gain).collect(),
        })
    }

    /// Inputs that are needed on either side of an output's centre.
    pub fn half_length(&self) -> usize {
        self.taps.len() / 2
    }

    /// Inputs that give this many outputs (at least one).
    pub fn input_length(&self, outputs: usize) -> usize {
        outputs.saturating_sub(1) * self.factor + 2 * self.half_length() + 1
    }

    /// Filters and decimates. Output `j` is centred on input `half_length() + j * factor`. There
    /// are as many as the input has the neighbours for, none if it is shorter than
    /// `input_length(1)`.
    pub fn apply(&self, input: &[f64]) -> Vec<f64> {
        let windows = input.windows(self.taps.len()).step_by(self.factor);
        let mut outputs = vec![0.0; windows.len()];
        f64::vectorised(
            #[inline(always)]
            || {
                for (output, window) in outputs.iter_mut().zip(windows) {
                    *output = self.weigh(window);
                }
            },
        );
        outputs
    }

    /// The sum of as many inputs as there are taps, each by its tap.
    #[inline(always)]
    fn weigh(&self, window: &[f64]) -> f64 {
        let (inputs, last_inputs) = window.as_chunks::<LANES>();
        let (taps, last_taps) = self.taps.as_chunks::<LANES>();
        let mut sums = [0.0; LANES];
        for (inputs, taps) in inputs.iter().zip(taps) {
            for ((sum, x), tap) in sums.iter_mut().zip(inputs).zip(taps) {
                *sum += x * tap;
            }
        }
        let last = last_inputs.iter().zip(last_taps).map(|(x, tap)| x * tap);
        sums.iter().sum::<f64>() + last.sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Gain at `frequency` of the output's Nyquist frequency, from the taps.
    fn gain(decimator: &Decimator, frequency: f64) -> f64 {
        let step = PI * frequency / decimator.factor as f64;
        let side = &decimator.taps[decimator.half_length()..];
        let sides = side[1..].iter().zip(1..);
        side[0]
            + 2.0
                * sides
                    .map(|(t, i)| t * (step * f64::from(i)).cos())
                    .sum::<f64>()
    }

    #[test]
    fn bands_are_as_promised() {
        for factor in [2, 3, 7, 25, 100] {
            let decimator = Decimator::new(factor).unwrap();
            let mut ripple: f64 = 0.0;
            let mut leak: f64 = 0.0;
            for i in 0..=1000 {
                let share = f64::from(i) / 1000.0;
                ripple = ripple.max((gain(&decimator, 0.8 * share) - 1.0).abs());
                leak = leak.max(gain(&decimator, 1.2 + share * (factor as f64 - 1.2)).abs());
            }
            assert!(ripple < 4e-5, "factor {factor}: ripple {ripple:e}");
            assert!(leak < 4e-5, "factor {factor}: leak {leak:e}");
            assert!((gain(&decimator, 0.0) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn outputs_are_centred_and_counted() {
        let decimator = Decimator::new(4).unwrap();
        let reach = decimator.half_length();
        assert_eq!(reach, 60);
        let line: Vec<f64> = (0..decimator.input_length(6)).map(|i| i as f64).collect();
        let output = decimator.apply(&line);
        assert_eq!(output.len(), 6);
        for (j, y) in output.iter().enumerate() {
            assert!((y - (reach + 4 * j) as f64).abs() < 1e-11);
        }
        assert_eq!(decimator.apply(&line[..line.len() - 1]).len(), 5);
        assert!(decimator.apply(&line[..2 * reach]).is_empty());
        assert!(decimator.apply(&[]).is_empty());
    }

    #[test]
    fn factor_one_passes_through_and_zero_is_refused() {
        let one = Decimator::new(1).unwrap();
        assert_eq!(one.half_length(), 0);
        assert_eq!(one.apply(&[1.0, -2.0, 3.5]), [1.0, -2.0, 3.5]);
        assert!(Decimator::new(0).is_err());
    }
}
