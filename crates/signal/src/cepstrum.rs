//! Families of equally spaced lines, gathered into one number each.

use crate::amplitude_spectrum::check;
use crate::error::Error;

/// Magnitudes below this share of the largest (−80 dB) count as that. Resampling is exact to it,
/// and a record of whole periods is 0 between its lines, where the logarithm has no value.
const FLOOR: f64 = 1e-4;

/// The real cepstrum c_q = (1/n) Σ_k ln|X_k| e^(2πi kq/n) of the samples about their mean, at
/// quefrencies q = 0 ..= n/2, in sample intervals. A family of lines at multiples of f shows as
/// peaks at multiples of 1/f. A factor on the signal changes c_0 alone.
///
/// Sources: Bogert, Healy, Tukey 1963; Randall 2017, "A history of cepstrum analysis and its
/// application to mechanical problems", Mechanical Systems and Signal Processing 97.
///
/// # Errors
/// Fewer than two samples, one that is not finite, or a constant signal.
pub fn real_cepstrum(x: &[f64]) -> Result<Vec<f64>, Error> {
    check(x, 1.0)?;
    if x.iter().all(|y| *y == x[0]) {
        return Err(Error::NoFluctuation);
    }
    let n = x.len();
    let mean = x.iter().sum::<f64>() / n as f64;
    let mut work: Vec<f64> = x.iter().map(|x| x - mean).collect();
    let spectrum = fourier::forward(&mut work);
    let largest = spectrum.iter().fold(0.0, |m: f64, c| m.max(c.norm_sqr()));
    if largest <= 0.0 {
        return Err(Error::NoFluctuation);
    }
    let logarithm = |square: f64| 0.5 * (square / largest).max(FLOOR * FLOOR).ln();
    let logarithms = spectrum.iter().map(|c| logarithm(c.norm_sqr()).into());
    let mut cepstrum = fourier::inverse(logarithms.collect(), n);
    cepstrum.truncate(n / 2 + 1);
    for c in &mut cepstrum {
        *c /= n as f64;
    }
    cepstrum[0] += 0.5 * largest.ln();
    Ok(cepstrum)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An echo of strength a after d samples: the cepstrum gains a/2 at d, −a²/4 at 2d, a³/6 at 3d.
    #[test]
    fn echo_shows_at_its_delay() {
        let mut x = vec![0.0; 4096];
        (x[5], x[105]) = (1.0, 0.5);
        let c = real_cepstrum(&x).unwrap();
        // Taking the mean off empties bin 0 alone: the floor there, over n samples.
        for (q, expected) in [(100, 0.25), (200, -0.0625), (300, 0.125 / 6.0), (50, 0.0)] {
            assert!((c[q] - expected).abs() < 3e-3, "{q}: {}", c[q]);
        }
    }

    #[test]
    fn scale_moves_the_first_value_alone() {
        let x: Vec<f64> = (0..300).map(|i| (f64::from(i * i) * 0.3).sin()).collect();
        let scaled: Vec<f64> = x.iter().map(|x| 8.0 * x).collect();
        let [one, other] = [real_cepstrum(&x).unwrap(), real_cepstrum(&scaled).unwrap()];
        assert!((other[0] - one[0] - 8f64.ln()).abs() < 1e-12);
        assert_eq!(one[1..], other[1..]);
    }

    #[test]
    fn bad_input_is_named() {
        assert_eq!(real_cepstrum(&[0.1; 9]), Err(Error::NoFluctuation));
        assert!(real_cepstrum(&[1.0]).is_err());
        assert!(real_cepstrum(&[1.0, f64::INFINITY]).is_err());
    }
}
