//! The envelope of what a signal holds in a frequency band, and its spectrum.

use crate::amplitude_spectrum::{AmplitudeSpectrum, amplitude_spectrum, check, sides};
use crate::error::{Error, positive};
use crate::windows::Window;
use fourier::Complex64;
use std::f64::consts::PI;

/// A frequency band. Its filter passes the centre whole and half the amplitude at the edges:
/// cos²(π(f − f_c)/2B) for |f − f_c| < B. Neighbouring bands of one width add up to 1. The Hann
/// shape keeps a filtered impact within ±2/B of its instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// f_c, Hz.
    pub centre: f64,
    /// B, Hz, between the points of half amplitude.
    pub width: f64,
}

/// The envelope |c(t)| of a signal in a band, at every sample. Here c is the complex envelope, the
/// filtered analytic signal, so that A cos(2πf_c t) has the envelope A. `sample_rate` in Hz.
///
/// The line from the first sample to the last is taken off before. The transform takes the
/// record as one period, and a jump from its end to its start would ring like an impact. Within
/// 2/B of its ends the envelope still mixes end and start.
///
/// Source: Randall and Antoni 2011, "Rolling element bearing diagnostics: a tutorial", Mechanical
/// Systems and Signal Processing 25(2), 5.2.
///
/// # Errors
/// Fewer than two samples, one that is not finite, a rate that is not positive, or a band that
/// does not lie between 0 and the Nyquist frequency.
pub fn envelope(x: &[f64], sample_rate: f64, band: Band) -> Result<Vec<f64>, Error> {
    let spectrum = Spectrum::new(x, sample_rate)?;
    positive("width of a frequency band, Hz", band.width)?;
    let nyquist = 0.5 * sample_rate;
    let half = 0.5 * band.width;
    // Rounding must not refuse the band from 0 to the Nyquist frequency.
    let slack = 1e-9 * nyquist;
    if !(half - slack..=nyquist - half + slack).contains(&band.centre) {
        return Err(Error::OutOfRange {
            what: "centre of a frequency band, Hz",
            value: band.centre,
            allowed: "half the band's width or more from 0 and from half the sample rate",
        });
    }
    let bins = x.len() as f64 / sample_rate;
    let complex = spectrum.complex_envelope(band.centre * bins, band.width * bins, x.len());
    Ok(complex.iter().map(|c| c.norm_sqr().sqrt()).collect())
}

/// The amplitude spectrum of the [`envelope`](envelope()) about its mean, through a Hann window.
/// Impacts that come f times a second show as lines at f, 2f, ...
///
/// # Errors
/// As [`envelope`](envelope()).
pub fn envelope_spectrum(
    x: &[f64],
    sample_rate: f64,
    band: Band,
) -> Result<AmplitudeSpectrum, Error> {
    let mut samples = envelope(x, sample_rate, band)?;
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    for y in &mut samples {
        *y -= mean;
    }
    amplitude_spectrum(&samples, sample_rate, Window::Hann)
}

/// The transform of a record without the line that joins its ends.
pub(crate) struct Spectrum {
    bins: Vec<Complex64>,
    samples: usize,
}

impl Spectrum {
    pub(crate) fn new(x: &[f64], sample_rate: f64) -> Result<Self, Error> {
        check(x, sample_rate)?;
        let n = x.len();
        let slope = (x[n - 1] - x[0]) / (n - 1) as f64;
        let line = |i: usize| x[0] + slope * i as f64;
        let mut work: Vec<f64> = x.iter().enumerate().map(|(i, x)| x - line(i)).collect();
        Ok(Self {
            bins: fourier::forward(&mut work),
            samples: n,
        })
    }

    /// Mean square of the record about its mean, the line taken off.
    pub(crate) fn variance(&self) -> f64 {
        let n = self.samples;
        let bins = self.bins.iter().enumerate().skip(1);
        let sum: f64 = bins.map(|(k, c)| sides(k, n) * c.norm_sqr()).sum();
        sum / (n * n) as f64
    }

    /// The complex envelope of a band at `points` equal steps over the record. Centre and width
    /// in bins; `points` is not below twice the width, or the bins that there are.
    pub(crate) fn complex_envelope(
        &self,
        centre: f64,
        width: f64,
        points: usize,
    ) -> Vec<Complex64> {
        let n = self.samples;
        let first = ((centre - width).floor() + 1.0).max(1.0) as usize;
        let end = ((centre + width).ceil() as usize).min(self.bins.len());
        let origin = centre as usize;
        // cos² of half the angle is (1 + cos)/2, and the cosine comes by turning a pointer.
        let mut pointer = Complex64::cis(PI * (first as f64 - centre) / width);
        let turn = Complex64::cis(PI / width);
        let mut envelope = vec![Complex64::ZERO; points];
        let mut place = (first + points - origin % points) % points;
        for (k, c) in self.bins.iter().enumerate().take(end).skip(first) {
            let weight = 0.5 * (1.0 + pointer.re) * sides(k, n) / n as f64;
            envelope[place] += c * weight;
            pointer *= turn;
            place = if place + 1 == points { 0 } else { place + 1 };
        }
        fourier::inverse_complex(&mut envelope);
        envelope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A carrier whose amplitude swings: sidebands a sixteenth of the width from the centre pass
    /// with cos²(π/32) of their amplitude.
    #[test]
    fn modulation_comes_back() {
        let time = |i: usize| i as f64 / 4096.0;
        let x: Vec<f64> = (0..4096)
            .map(|i| {
                let swing = 2.0 + (TAU * 16.0 * time(i)).cos();
                5.0 + swing * (TAU * 1024.0 * time(i)).cos() + 9.0 * (TAU * 100.0 * time(i)).sin()
            })
            .collect();
        let band = Band {
            centre: 1024.0,
            width: 256.0,
        };
        let swing = (PI / 32.0).cos().powi(2);
        let envelope = envelope(&x, 4096.0, band).unwrap();
        // 2/B is 32 samples; outside of that, what the line leaves.
        for (i, y) in envelope.iter().enumerate().take(4096 - 32).skip(32) {
            let expected = 2.0 + swing * (TAU * 16.0 * time(i)).cos();
            assert!((y - expected).abs() < 5e-3, "{i}: {y} {expected}");
        }
        let spectrum = envelope_spectrum(&x, 4096.0, band).unwrap();
        assert!((spectrum.amplitude[16] - swing).abs() < 1e-3);
        assert!(spectrum.amplitude[40..].iter().all(|a| *a < 1e-3));
    }

    #[test]
    fn bands_of_one_width_add_up() {
        let x: Vec<f64> = (0..500).map(|i| (f64::from(i * i) * 0.01).sin()).collect();
        let spectrum = Spectrum::new(&x, 1.0).unwrap();
        let sum = |width: f64| {
            let mut sum = vec![Complex64::ZERO; 500];
            for b in 0..5 {
                let centre = (f64::from(b) + 0.5) * width;
                let shift = centre as usize;
                let band = spectrum.complex_envelope(centre, width, 500);
                for (i, (s, c)) in sum.iter_mut().zip(band).enumerate() {
                    *s += c * Complex64::cis(TAU * (shift * i % 500) as f64 / 500.0);
                }
            }
            sum
        };
        // 25 to 225 of 250 bins, where the two bands that overlap are both there.
        let together = fft_of(&sum(50.0));
        for (k, c) in together.iter().enumerate().take(225).skip(25) {
            let whole = spectrum.bins[k] * 2.0;
            assert!((c - whole).norm() < 1e-10, "{k}");
        }
    }

    fn fft_of(x: &[Complex64]) -> Vec<Complex64> {
        let mut conjugate: Vec<Complex64> = x.iter().map(Complex64::conj).collect();
        fourier::inverse_complex(&mut conjugate);
        conjugate.iter().map(Complex64::conj).collect()
    }

    #[test]
    fn bad_bands_are_refused() {
        let try_band = |centre, width| envelope(&[1.0, 2.0, 0.0, 1.0], 8.0, Band { centre, width });
        assert!(try_band(2.0, 4.0).is_ok());
        assert!(try_band(1.9, 4.0).is_err());
        assert!(try_band(2.1, 4.0).is_err());
        assert!(try_band(f64::NAN, 1.0).is_err());
        assert!(try_band(2.0, 0.0).is_err());
    }
}
