//! 1/f noise.

use crate::error::Error;
use fourier::Complex64;

/// `n` samples of Gaussian noise whose power density falls as 1/f, from 1/T (T being the length
/// of the record) to the Nyquist frequency, with nothing at 0 Hz.
///
/// The expected mean square of the samples is `rms`²; a single record scatters about it. The
/// noise is periodic in the record: its end joins its start. `normal` gives independent standard
/// normal numbers and is called n − 1 times.
///
/// Made by shaping white noise in the frequency domain: Timmer and König 1995, "On generating
/// power law noise", Astronomy and Astrophysics 300, 707.
///
/// # Errors
/// An `rms` that is negative or not finite.
pub fn pink_noise(n: usize, rms: f64, mut normal: impl FnMut() -> f64) -> Result<Vec<f64>, Error> {
    if !(rms.is_finite() && rms >= 0.0) {
        return Err(Error::OutOfRange {
            what: "RMS of the noise",
            value: rms,
            allowed: "finite and not negative",
        });
    }
    if n < 2 {
        return Ok(vec![0.0; n]);
    }
    // The bin at the Nyquist frequency reaches only half its width below it.
    let share = |k: usize| if 2 * k == n { 0.5 } else { 1.0 } / k as f64;
    let whole: f64 = (1..=n / 2).map(share).sum();
    let bin = |k: usize| {
        let deviation = rms * (share(k) / whole).sqrt();
        if 2 * k == n {
            Complex64::from(deviation * normal())
        } else {
            Complex64::new(normal(), normal()) * (0.5 * deviation)
        }
    };
    let spectrum = std::iter::once(Complex64::ZERO).chain((1..=n / 2).map(bin));
    Ok(fourier::inverse(spectrum.collect(), n))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Standard normal numbers by Box and Muller from a linear congruential generator.
    fn normals(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        let mut uniform = move || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            ((state >> 11) as f64 + 0.5) / (1u64 << 53) as f64
        };
        move || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
    }

    /// Mean square over many records, within four standard errors.
    #[test]
    fn expected_mean_square_is_that_asked_for() {
        for n in [2, 3, 64, 101] {
            let mut normal = normals(7 + n as u64);
            let squares: Vec<f64> = (0..4000)
                .map(|_| {
                    let x = pink_noise(n, 2.5, &mut normal).unwrap();
                    x.iter().map(|x| x * x).sum::<f64>() / n as f64
                })
                .collect();
            let mean = squares.iter().sum::<f64>() / 4000.0;
            let variance = squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / 4000.0;
            assert!(
                (mean - 6.25).abs() < 4.0 * (variance / 4000.0).sqrt(),
                "n = {n}: {mean}"
            );
        }
    }

    /// Power per bin times frequency is the same everywhere, the Nyquist bin included.
    #[test]
    fn power_falls_as_one_over_f() {
        let n = 512;
        let mut normal = normals(3);
        let mut power = vec![0.0; n / 2 + 1];
        for _ in 0..3000 {
            let mut x = pink_noise(n, 1.0, &mut normal).unwrap();
            for (sum, c) in power.iter_mut().zip(fourier::forward(&mut x)) {
                *sum += c.norm_sqr() / 3000.0;
            }
        }
        assert!(power[0] < 1e-20 * power[1]);
        for k in [2, 4, 16, 64, 255, 256] {
            let slope = power[k] * k as f64 / power[1];
            // Each bin scatters by 1/√3000, 1.8 %, the last by √2 times that.
            assert!((slope - 1.0).abs() < 0.1, "bin {k}: {slope}");
        }
    }

    #[test]
    fn numbers_are_drawn_once_each() {
        for n in [2, 9, 16] {
            let mut drawn = 0;
            pink_noise(n, 1.0, || {
                drawn += 1;
                0.3
            })
            .unwrap();
            assert_eq!(drawn, n - 1);
        }
        assert_eq!(pink_noise(1, 1.0, || 1.0), Ok(vec![0.0]));
        assert!(pink_noise(8, -1.0, || 1.0).is_err());
        assert!(pink_noise(8, f64::NAN, || 1.0).is_err());
    }
}
