//! Complex amplitudes of the shaft's orders, with the noise that stands around each.

use crate::angle_resampling::Revolutions;
use crate::error::Error;
use fourier::Complex64;

/// The lines of a channel over the crank angle: index `k` holds order `k`, from 0 on.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderLines {
    /// c_k of the crank-angle synchronous mean, x̄(θ) = Re Σ c_k e^(ikθ); c_0 is the mean.
    pub amplitude: Vec<Complex64>,
    /// Variance of |c_k| about its expectation: of real and imaginary part together. Whatever is not
    /// synchronous with the shaft, noise or chaos, counts. It is an estimate, and widened for that:
    /// the mean of |c_k − E c_k|² over it is 1.
    pub variance: Vec<f64>,
    /// Revolutions that were averaged over.
    pub revolutions: usize,
}

/// Fewest bins on either side of an order from which its noise is estimated. The ratio of a power to the mean of two bins
/// has no variance, and that to the mean of eight is above 8 once in 450.
const FEWEST: usize = 4;

/// The lines up to order `highest`.
///
/// Over R revolutions the discrete Fourier transform has R − 1 bins between two orders. A signal
/// that repeats every revolution has nothing there. The mean power of the bins around an order,
/// half-way to the next ones, is therefore that of the noise in it, of any colour. B bins have
/// 2B degrees of freedom. The ratio of a power to the mean of B others has the mean
/// 2B/(2B − 2) (an F distribution's), by which the variance is widened. With few revolutions so few bins
/// would leave the variance to chance: then [`FEWEST`] bins on either side are taken, those beyond the next orders included.
/// With fewer than three revolutions the variance is 0.
///
/// # Errors
/// `highest` not below half the points per revolution.
pub fn order_lines(x: &Revolutions, highest: usize) -> Result<OrderLines, Error> {
    let n = x.points_per_revolution();
    if 2 * highest >= n {
        return Err(Error::OutOfRange {
            what: "highest order",
            value: highest as f64,
            allowed: "below half the points per revolution",
        });
    }
    let count = x.count();
    let mut work = x.samples().to_vec();
    let scale = 2.0 / work.len() as f64;
    let spectrum = fourier::forward(&mut work);
    let offsets: Vec<usize> = match (count - 1) / 2 {
        0 => Vec::new(),
        reach => (1..)
            .filter(|offset| offset % count != 0)
            .take(reach.max(FEWEST))
            .collect(),
    };
    let noise = |bin: usize| {
        let power = |offset: &usize| {
            // Below order 0 the spectrum is its own mirror image.
            let below = spectrum[bin.abs_diff(*offset)].norm_sqr();
            Some(below + spectrum.get(bin + offset)?.norm_sqr())
        };
        let powers: Vec<f64> = offsets.iter().filter_map(power).collect();
        let degrees = (4 * powers.len()) as f64;
        match powers.is_empty() {
            true => 0.0,
            false => {
                degrees / (degrees - 2.0) * powers.iter().sum::<f64>() / (2 * powers.len()) as f64
            }
        }
    };
    let of_order = |k: usize| {
        let scale = if k == 0 { 0.5 * scale } else { scale };
        let amplitude = spectrum[k * count] * x.phase(k) * scale;
        (amplitude, noise(k * count) * scale * scale)
    };
    let (amplitude, variance) = (0..=highest).map(of_order).unzip();
    Ok(OrderLines {
        amplitude,
        variance,
        revolutions: count,
    })
}

/// By how much the lines of each revolution differ from those of the synchronous mean, up to order `highest`, which is below half
/// the points per revolution.
pub fn deviations(x: &Revolutions, highest: usize) -> Vec<Vec<Complex64>> {
    let mean = x.synchronous_mean();
    let scale = |k: usize| if k == 0 { 1.0 } else { 2.0 } / mean.len() as f64;
    let of_revolution = |samples: &[f64]| {
        let mut apart: Vec<f64> = samples
            .iter()
            .zip(&mean)
            .map(|(x, mean)| x - mean)
            .collect();
        let spectrum = fourier::forward(&mut apart);
        let line = |k: usize| spectrum[k] * x.phase(k) * scale(k);
        (0..=highest).map(line).collect()
    };
    x.iter().map(of_revolution).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle_resampling::AngleGrid;
    use crate::crank_angle::CrankAngle;
    use std::f64::consts::TAU;

    const PER_REVOLUTION: usize = 256;

    fn resampled(revolutions: usize, wave: impl FnMut(usize) -> f64) -> Revolutions {
        let samples = revolutions * PER_REVOLUTION;
        let angle: Vec<f64> = (0..samples)
            .map(|i| (TAU * i as f64 / PER_REVOLUTION as f64).rem_euclid(TAU))
            .collect();
        let grid = AngleGrid::new(&CrankAngle::from_encoder(&angle).unwrap(), PER_REVOLUTION);
        let x: Vec<f64> = (0..samples).map(wave).collect();
        grid.unwrap().resample(&x).unwrap()
    }

    fn lines(revolutions: usize, wave: impl FnMut(usize) -> f64) -> OrderLines {
        order_lines(&resampled(revolutions, wave), 60).unwrap()
    }

    #[test]
    fn every_other_revolution_of_a_subharmonic_is_as_far_from_the_mean() {
        // Order 3.5 of amplitude 2 is the negative of itself a revolution later, and order 5 is in the mean.
        let x = resampled(8, |i| {
            let angle = TAU * i as f64 / PER_REVOLUTION as f64;
            2.0 * (3.5 * angle).cos() + (5.0 * angle).cos()
        });
        let all = deviations(&x, 60);
        assert_eq!(all.len(), 8);
        let power = |lines: &[Complex64]| lines[1..].iter().map(|c| c.norm_sqr()).sum::<f64>();
        for pair in all.chunks(2) {
            let sum = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a + b).norm());
            assert!(sum.fold(0.0, f64::max) < 1e-9);
            let mean_square = pair[0][0].norm_sqr() + 0.5 * power(&pair[0]);
            assert!((mean_square - 2.0).abs() < 0.02, "{mean_square}");
        }
    }

    #[test]
    fn amplitudes_and_phases_come_back_and_leave_no_noise() {
        let lines = lines(12, |i| {
            let angle = TAU * i as f64 / PER_REVOLUTION as f64;
            1.5 + 3.0 * (angle + 0.4).cos() + 0.2 * (17.0 * angle).sin()
        });
        assert_eq!(lines.revolutions, 12);
        for (k, c) in lines.amplitude.iter().enumerate() {
            let expected = match k {
                0 => Complex64::new(1.5, 0.0),
                1 => Complex64::from_polar(3.0, 0.4),
                17 => Complex64::new(0.0, -0.2),
                _ => Complex64::ZERO,
            };
            assert!((c - expected).norm() < 1e-6, "order {k}: {c}");
        }
        assert!(lines.variance.iter().all(|v| *v < 1e-12));
    }

    /// White noise of variance s² leaves an amplitude of variance 4 s²/N.
    #[test]
    fn the_variance_is_that_of_the_noise() {
        let mut state = 1_u64;
        let lines = lines(40, |_| white(&mut state));
        let expected = 4.0 / 12.0 / (40 * PER_REVOLUTION) as f64;
        let mean = lines.variance[1..].iter().sum::<f64>() / 60.0;
        assert!((mean / expected - 1.0).abs() < 0.1, "{mean} {expected}");
        let powers = lines.amplitude[1..].iter().map(|c| c.norm_sqr());
        let found = powers.sum::<f64>() / 60.0;
        assert!((found / expected - 1.0).abs() < 0.5, "{found} {expected}");
    }

    /// White noise: uniform from −1/2 to 1/2, by a linear congruential generator (Knuth's MMIX).
    fn white(state: &mut u64) -> f64 {
        *state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (*state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }

    /// Of three revolutions the two bins beside an order are too few: one line in 440 would be 20 times its variance.
    #[test]
    fn the_variance_of_three_revolutions_is_not_left_to_chance() {
        let mut state = 1_u64;
        let mut ratios = Vec::new();
        for _ in 0..40 {
            let lines = lines(3, |_| white(&mut state));
            let both = lines.amplitude.iter().zip(&lines.variance).skip(1);
            ratios.extend(both.map(|(c, variance)| c.norm_sqr() / variance));
        }
        let greatest = ratios.iter().copied().fold(0.0, f64::max);
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        assert!(greatest < 20.0, "{greatest}");
        assert!((mean - 1.0).abs() < 0.1, "{mean}");
    }

    #[test]
    fn one_revolution_has_lines_without_noise() {
        let lines = lines(1, |i| (TAU * i as f64 / PER_REVOLUTION as f64).cos());
        assert!((lines.amplitude[1].re - 1.0).abs() < 0.05);
        assert!(lines.variance.iter().all(|v| *v == 0.0));
    }
}
