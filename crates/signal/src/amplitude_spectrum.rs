//! Amplitudes and mean squares over frequency.

use crate::error::{Error, positive};
use crate::windows::{Window, coherent_gain};
use fourier::Complex64;

/// A single-sided amplitude spectrum: a sine of amplitude A on a bin shows A there.
#[derive(Clone, Debug, PartialEq)]
pub struct AmplitudeSpectrum {
    /// Distance of two bins, Hz.
    pub resolution: f64,
    /// Amplitude at `resolution` times the index, in the unit of the samples; the first is the
    /// magnitude of the mean.
    pub amplitude: Vec<f64>,
}

impl AmplitudeSpectrum {
    /// The frequency axis, Hz.
    pub fn frequencies(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.amplitude.len()).map(|k| k as f64 * self.resolution)
    }
}

/// The amplitude spectrum 2|Σ w_i x_i e^(−2πi ik/n)| / Σw, without the 2 at 0 Hz and at the
/// Nyquist frequency. `sample_rate` in Hz.
///
/// The mean is not removed; with a tapering window it also shows in the first bins beside 0 Hz.
///
/// # Errors
/// Fewer than two samples, a sample that is not finite, or a sample rate that is not positive.
pub fn amplitude_spectrum(
    x: &[f64],
    sample_rate: f64,
    window: Window,
) -> Result<AmplitudeSpectrum, Error> {
    check(x, sample_rate)?;
    let n = x.len();
    let weights = window.weights(n);
    let scale = 1.0 / (n as f64 * coherent_gain(&weights));
    let spectrum = weighted_transform(x, 0.0, &weights);
    let amplitude = spectrum.iter().enumerate();
    Ok(AmplitudeSpectrum {
        resolution: sample_rate / n as f64,
        amplitude: amplitude
            .map(|(k, c)| sides(k, n) * scale * c.norm_sqr().sqrt())
            .collect(),
    })
}

/// Mean square per frequency band, in the square of the samples' unit.
///
/// Band `b` is `edges[b] <= f < edges[b + 1]`, in Hz; the last also has its upper edge. Bands
/// from 0 to the Nyquist frequency (or beyond) add up to the mean square about the mean, exactly
/// (Parseval). The windowed spectrum determines each band's share, the samples the sum.
///
/// # Errors
/// As [`amplitude_spectrum`], or edges that do not increase.
pub fn band_mean_squares(
    x: &[f64],
    sample_rate: f64,
    window: Window,
    edges: &[f64],
) -> Result<Vec<f64>, Error> {
    check(x, sample_rate)?;
    // Written so that an edge that is not a number is found too.
    let increases = |pair: &[f64]| pair[0] < pair[1];
    if let Some(pair) = edges.windows(2).find(|pair| !increases(pair)) {
        return Err(Error::OutOfRange {
            what: "edge of a frequency band, Hz",
            value: pair[1],
            allowed: "above the edge before",
        });
    }
    let n = x.len();
    let mean = x.iter().sum::<f64>() / n as f64;
    let mean_square = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n as f64;
    let spectrum = weighted_transform(x, mean, &window.weights(n));

    let mut bands = vec![0.0; edges.len().saturating_sub(1)];
    let mut total = 0.0;
    for (k, c) in spectrum.iter().enumerate() {
        let energy = sides(k, n) * c.norm_sqr();
        total += energy;
        let frequency = k as f64 * sample_rate / n as f64;
        let at_the_end = edges.last() == Some(&frequency);
        let below = edges.partition_point(|&edge| edge <= frequency);
        let band = below.checked_sub(1 + usize::from(at_the_end));
        if let Some(sum) = band.and_then(|b| bands.get_mut(b)) {
            *sum += energy;
        }
    }
    if total > 0.0 {
        for band in &mut bands {
            *band *= mean_square / total;
        }
    }
    Ok(bands)
}

/// Checks that there are two samples at least, all finite, at a rate above zero.
pub(crate) fn check(x: &[f64], sample_rate: f64) -> Result<(), Error> {
    positive("sample rate, Hz", sample_rate)?;
    if x.len() < 2 {
        return Err(Error::TooFewSamples {
            needed: 2,
            got: x.len(),
        });
    }
    match x.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(Error::NotFinite { index }),
        None => Ok(()),
    }
}

/// How many sides of the two-sided spectrum bin `k` of `n` samples stands for.
pub(crate) fn sides(k: usize, n: usize) -> f64 {
    if k == 0 || 2 * k == n { 1.0 } else { 2.0 }
}

fn weighted_transform(x: &[f64], mean: f64, weights: &[f64]) -> Vec<Complex64> {
    let mut work: Vec<f64> = x.iter().zip(weights).map(|(x, w)| (x - mean) * w).collect();
    fourier::forward(&mut work)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn sine(amplitude: f64, bin: f64, n: usize) -> impl Iterator<Item = f64> {
        (0..n).map(move |i| amplitude * (TAU * bin * i as f64 / n as f64 + 0.4).sin())
    }

    #[test]
    fn sine_on_a_bin_shows_its_amplitude_in_every_window() {
        for window in [Window::Rectangular, Window::Hann, Window::FlatTop] {
            let x: Vec<f64> = sine(3.5, 20.0, 250).collect();
            let spectrum = amplitude_spectrum(&x, 1000.0, window).unwrap();
            assert_eq!(spectrum.amplitude.len(), 126);
            assert!((spectrum.amplitude[20] - 3.5).abs() < 1e-13);
            assert!(spectrum.amplitude[40] < 1e-13);
            assert_eq!(spectrum.frequencies().nth(20), Some(80.0));
        }
    }

    #[test]
    fn mean_and_nyquist_count_once() {
        let x: Vec<f64> = (0..64)
            .map(|i| 2.0 + if i % 2 == 0 { 0.5 } else { -0.5 })
            .collect();
        let spectrum = amplitude_spectrum(&x, 64.0, Window::Rectangular).unwrap();
        assert!((spectrum.amplitude[0] - 2.0).abs() < 1e-14);
        assert!((spectrum.amplitude[32] - 0.5).abs() < 1e-14);
    }

    /// The largest scallop loss of the coefficients is 0.01 dB.
    #[test]
    fn flat_top_reads_a_sine_between_bins() {
        for fraction in [0.1, 0.25, 0.5] {
            let x: Vec<f64> = sine(1.0, 20.0 + fraction, 256).collect();
            let spectrum = amplitude_spectrum(&x, 256.0, Window::FlatTop).unwrap();
            let peak = spectrum.amplitude.iter().copied().fold(0.0, f64::max);
            assert!((peak - 1.0).abs() < 1.2e-3, "{fraction}: {peak}");
        }
    }

    #[test]
    fn band_holds_half_the_square_of_its_sine() {
        let x: Vec<f64> = sine(3.0, 10.0, 400)
            .zip(sine(0.2, 100.0, 400))
            .map(|(a, b)| 7.0 + a + b)
            .collect();
        for window in [Window::Rectangular, Window::Hann] {
            let bands = band_mean_squares(&x, 400.0, window, &[0.0, 50.0, 80.0, 200.0]).unwrap();
            assert!((bands[0] - 4.5).abs() < 1e-12);
            assert!(bands[1] < 1e-12);
            assert!((bands[2] - 0.02).abs() < 1e-12);
        }
    }

    #[test]
    fn upper_edge_belongs_to_the_last_band_alone() {
        let x: Vec<f64> = (0..8)
            .map(|i| if i % 2 == 0 { 1.0 } else { -1.0 })
            .collect();
        let bands = band_mean_squares(&x, 8.0, Window::Rectangular, &[0.0, 2.0, 4.0]).unwrap();
        assert!((bands[1] - 1.0).abs() < 1e-15);
        let bands = band_mean_squares(&x, 8.0, Window::Rectangular, &[0.0, 4.0, 5.0]).unwrap();
        assert!(bands[0] < 1e-15 && (bands[1] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn bad_input_is_named() {
        let few = amplitude_spectrum(&[1.0], 1.0, Window::Hann);
        assert_eq!(few, Err(Error::TooFewSamples { needed: 2, got: 1 }));
        let nan = amplitude_spectrum(&[1.0, f64::NAN], 1.0, Window::Hann);
        assert_eq!(nan, Err(Error::NotFinite { index: 1 }));
        assert!(amplitude_spectrum(&[1.0, 2.0], 0.0, Window::Hann).is_err());
        for edges in [[1.0, 1.0], [2.0, 1.0], [0.0, f64::NAN]] {
            assert!(band_mean_squares(&[1.0, 2.0], 1.0, Window::Hann, &edges).is_err());
        }
        assert_eq!(
            band_mean_squares(&[4.0; 5], 1.0, Window::Hann, &[0.0, 1.0]),
            Ok(vec![0.0])
        );
    }
}
