//! The shape of a spectrum in three numbers.

use crate::error::Error;
use crate::welch::PowerSpectralDensity;

/// Where the power of a spectrum lies and how widely it is spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralShape {
    /// f̄ = Σ f_k p_k, Hz, with p_k = S_k/ΣS.
    pub centroid: f64,
    /// √Σ (f_k − f̄)² p_k, Hz.
    pub spread: f64,
    /// −Σ p_k ln p_k / ln K over K bins: 0 for a single line, 1 for a flat spectrum.
    pub entropy: f64,
}

/// The shape of a power spectral density, its bins taken as a distribution over frequency.
///
/// Sources: Peeters 2004, "A large set of audio features for sound description", IRCAM, 6.1;
/// entropy: Shannon 1948, normalised as Inouye et al. 1991, Electroenceph. Clin. Neurophysiol. 79.
///
/// # Errors
/// A spectrum without power or of a single bin.
pub fn spectral_shape(spectrum: &PowerSpectralDensity) -> Result<SpectralShape, Error> {
    let total: f64 = spectrum.density.iter().sum();
    let bins = spectrum.density.len();
    if bins < 2 || !total.is_finite() || total <= 0.0 {
        return Err(Error::NoFluctuation);
    }
    let shares = || spectrum.density.iter().map(|s| s / total).enumerate();
    let index: f64 = shares().map(|(k, p)| k as f64 * p).sum();
    let variance: f64 = shares().map(|(k, p)| (k as f64 - index).powi(2) * p).sum();
    let entropy: f64 = shares()
        .filter(|(_, p)| *p > 0.0)
        .map(|(_, p)| -p * p.ln())
        .sum();
    Ok(SpectralShape {
        centroid: index * spectrum.resolution,
        spread: variance.sqrt() * spectrum.resolution,
        entropy: entropy / (bins as f64).ln(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(density: &[f64]) -> Result<SpectralShape, Error> {
        spectral_shape(&PowerSpectralDensity {
            resolution: 10.0,
            density: density.to_vec(),
        })
    }

    /// A uniform distribution over K bins has the variance (K² − 1)/12.
    #[test]
    fn flat_spectrum_and_lines_have_closed_forms() {
        let flat = shape(&[0.3; 65]).unwrap();
        assert!((flat.centroid - 320.0).abs() < 1e-10);
        assert!((flat.spread - 10.0 * ((65.0f64 * 65.0 - 1.0) / 12.0).sqrt()).abs() < 1e-10);
        assert!((flat.entropy - 1.0).abs() < 1e-13);
        let line = shape(&[0.0, 0.0, 5.0, 0.0]).unwrap();
        assert_eq!((line.centroid, line.spread, line.entropy), (20.0, 0.0, 0.0));
        let two = shape(&[0.0, 2.0, 0.0, 2.0]).unwrap();
        assert_eq!((two.centroid, two.spread, two.entropy), (20.0, 10.0, 0.5));
    }

    #[test]
    fn spectrum_without_power_has_no_shape() {
        assert_eq!(shape(&[0.0; 5]), Err(Error::NoFluctuation));
        assert_eq!(shape(&[]), Err(Error::NoFluctuation));
        assert_eq!(shape(&[f64::NAN; 5]), Err(Error::NoFluctuation));
    }
}
