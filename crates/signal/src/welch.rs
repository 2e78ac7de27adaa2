//! Power spectral density, averaged over segments of the record.

use crate::amplitude_spectrum::{check, sides};
use crate::error::Error;
use crate::segments::Segments;
use crate::windows::Window;
use fourier::Complex64;

/// A single-sided power spectral density.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerSpectralDensity {
    /// Distance of two bins, Hz.
    pub resolution: f64,
    /// Density at `resolution` times the index, in the square of the samples' unit per Hz. Times
    /// the resolution, the bins add up to the mean square about the mean, on average.
    pub density: Vec<f64>,
}

impl PowerSpectralDensity {
    /// The bins at frequencies up to `highest`, Hz, and no others. Two recordings of one motion agree
    /// up to a frequency that both resolve, also at different sample rates.
    pub fn up_to(mut self, highest: f64) -> Self {
        // A cast saturates: 0 Hz is left of a negative frequency, all of an infinite one.
        let bins = ((highest / self.resolution) as usize).saturating_add(1);
        self.density.truncate(bins);
        self
    }
}

/// The power spectral density over segments of `segment` samples that overlap by half: see
/// [`welch_over`].
///
/// # Errors
/// A segment of fewer than two samples or longer than the record, a sample that is not finite, or
/// a sample rate that is not positive.
pub fn welch(
    x: &[f64],
    sample_rate: f64,
    window: Window,
    segment: usize,
) -> Result<PowerSpectralDensity, Error> {
    let segments = Segments::overlapping(x.len(), segment);
    welch_over(x, sample_rate, window, &segments)
}

/// The power spectral density (2/(f_s Σw²)) ⟨|Σ w_i (x_i − x̄) e^(−2πi ik/m)|²⟩, without the 2 at
/// 0 Hz and at the Nyquist frequency. It is the mean over `segments` of m samples, each with its own mean
/// taken off. `sample_rate` in Hz.
///
/// Source: Welch 1967, "The use of fast Fourier transform for the estimation of power spectra",
/// IEEE Trans. Audio Electroacoustics 15(2).
///
/// # Errors
/// Segments of fewer than two samples, none, or one that ends beyond the record; a sample that is not
/// finite, or a sample rate that is not positive.
pub fn welch_over(
    x: &[f64],
    sample_rate: f64,
    window: Window,
    segments: &Segments,
) -> Result<PowerSpectralDensity, Error> {
    let segment = segments.length;
    let mut sums = vec![0.0; segment / 2 + 1];
    let count = for_each_segment(x, sample_rate, window, segments, |spectrum| {
        for (sum, c) in sums.iter_mut().zip(spectrum) {
            *sum += c.norm_sqr();
        }
    })?;
    let squares: f64 = window.weights(segment).iter().map(|w| w * w).sum();
    let scale = 1.0 / (sample_rate * squares * count as f64);
    let density = sums.iter().enumerate();
    Ok(PowerSpectralDensity {
        resolution: sample_rate / segment as f64,
        density: density
            .map(|(k, sum)| sides(k, segment) * scale * sum)
            .collect(),
    })
}

/// Hands the transform of each windowed segment to `take` and returns how many there are.
pub(crate) fn for_each_segment(
    x: &[f64],
    sample_rate: f64,
    window: Window,
    segments: &Segments,
    mut take: impl FnMut(&[Complex64]),
) -> Result<usize, Error> {
    check(x, sample_rate)?;
    let segment = segments.length;
    if segment < 2 {
        return Err(Error::OutOfRange {
            what: "samples per segment",
            value: segment as f64,
            allowed: "2 or more",
        });
    }
    let needed = segment + segments.starts.iter().max().unwrap_or(&0);
    if x.len() < needed {
        return Err(Error::TooFewSamples {
            needed,
            got: x.len(),
        });
    }
    let weights = window.weights(segment);
    let mut work = vec![0.0; segment];
    for start in &segments.starts {
        let samples = &x[*start..start + segment];
        let mean = samples.iter().sum::<f64>() / segment as f64;
        for ((y, x), w) in work.iter_mut().zip(samples).zip(&weights) {
            *y = (x - mean) * w;
        }
        take(&fourier::forward(&mut work));
    }
    match segments.starts.len() {
        0 => Err(Error::NoFluctuation),
        count => Ok(count),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A sine on a bin: A²/2 in all, of which a Hann window puts 2/3 into the bin and 1/6 into
    /// either neighbour.
    #[test]
    fn sine_keeps_its_power() {
        let x: Vec<f64> = (0..1000)
            .map(|i| 7.0 + 3.0 * (TAU * 16.0 * f64::from(i) / 128.0).sin())
            .collect();
        let psd = welch(&x, 1280.0, Window::Hann, 128).unwrap();
        assert_eq!((psd.resolution, psd.density.len()), (10.0, 65));
        for (k, share) in [(15, 1.0 / 6.0), (16, 2.0 / 3.0), (17, 1.0 / 6.0), (18, 0.0)] {
            assert!((psd.density[k] * psd.resolution - 4.5 * share).abs() < 1e-12);
        }
    }

    #[test]
    fn bins_up_to_a_frequency_are_kept() {
        let psd = || welch(&[1.0, -1.0, 2.0, 0.0], 40.0, Window::Rectangular, 4).unwrap();
        for (highest, bins) in [
            (9.0, 1),
            (10.0, 2),
            (19.9, 2),
            (20.0, 3),
            (f64::INFINITY, 3),
        ] {
            assert_eq!(psd().up_to(highest).density.len(), bins);
        }
    }

    #[test]
    fn bad_input_is_named() {
        let few = welch(&[1.0; 7], 1.0, Window::Hann, 8);
        assert_eq!(few, Err(Error::TooFewSamples { needed: 8, got: 7 }));
        assert!(welch(&[1.0; 7], 1.0, Window::Hann, 1).is_err());
        assert!(welch(&[1.0; 7], f64::NAN, Window::Hann, 4).is_err());
        let nan = welch(&[1.0, 2.0, f64::NAN], 1.0, Window::Hann, 2);
        assert_eq!(nan, Err(Error::NotFinite { index: 2 }));
    }
}
