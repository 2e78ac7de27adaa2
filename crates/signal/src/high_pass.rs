//! A coupling that does not pass what is constant: a capacitor, a charge amplifier.

use crate::error::{Error, positive};
use fourier::Complex64;
use std::f64::consts::PI;

/// A high-pass of the first order, H(f) = if / (if + f_c).
///
/// Of samples it is made by the bilinear transform, exact at f_c (Oppenheim and Schafer 2010, 7.2.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighPass {
    gain: f64,
    pole: f64,
}

impl HighPass {
    /// −3 dB at `cutoff`, Hz.
    ///
    /// # Errors
    /// A frequency that is not between 0 and half the sample rate.
    pub fn new(cutoff: f64, sample_rate: f64) -> Result<Self, Error> {
        positive("sample rate, Hz", sample_rate)?;
        if !(cutoff > 0.0 && cutoff < 0.5 * sample_rate) {
            return Err(Error::OutOfRange {
                what: "frequency of a filter, Hz",
                value: cutoff,
                allowed: "above 0 and below half the sample rate",
            });
        }
        let g = (PI * cutoff / sample_rate).tan();
        Ok(Self {
            gain: 1.0 / (1.0 + g),
            pole: (1.0 - g) / (1.0 + g),
        })
    }

    /// Filters samples of a signal that was on for long before the first of them: as if they had been repeated ever since.
    pub fn apply(&self, samples: &mut [f64]) {
        let Some(last) = samples.last().copied() else {
            return;
        };
        let run = |before: f64, then: &mut dyn FnMut(usize, f64)| {
            let (mut y, mut x_before) = (before, last);
            for (i, x) in samples.iter().enumerate() {
                y = self.pole * y + self.gain * (x - x_before);
                x_before = *x;
                then(i, y);
            }
            y
        };
        // What is left of the value before the first sample fades by the pole with each.
        let from_rest = run(0.0, &mut |_, _| ());
        let before = from_rest / (1.0 - self.pole.powi(samples.len() as i32));
        let mut filtered = Vec::with_capacity(samples.len());
        run(before, &mut |_, y| filtered.push(y));
        samples.copy_from_slice(&filtered);
    }

    /// Its response at a frequency over the cutoff.
    pub fn response(ratio: f64) -> Complex64 {
        let turning = Complex64::new(0.0, ratio);
        turning / (turning + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_wave_comes_out_as_the_response_says_and_a_constant_not_at_all() {
        let (rate, periods, count) = (1000.0, 7.0, 900);
        let frequency = periods * rate / count as f64;
        for cutoff in [0.1 * frequency, frequency, 5.0 * frequency] {
            let angle = |i: usize| TAU * periods * i as f64 / count as f64;
            let mut samples: Vec<f64> = (0..count).map(|i| 3.0 + angle(i).cos()).collect();
            HighPass::new(cutoff, rate).unwrap().apply(&mut samples);
            let response = HighPass::response(frequency / cutoff);
            for (i, y) in samples.iter().enumerate() {
                let expected = (response * Complex64::cis(angle(i))).re;
                assert!((y - expected).abs() < 5e-3, "{i} {y} {expected}");
            }
        }
    }

    #[test]
    fn a_frequency_beyond_half_the_rate_is_an_error() {
        for cutoff in [0.0, -1.0, 500.0, f64::NAN] {
            assert!(HighPass::new(cutoff, 1000.0).is_err(), "{cutoff}");
        }
        HighPass::new(1.0, 1000.0).unwrap().apply(&mut []);
    }
}
