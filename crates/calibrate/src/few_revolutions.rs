//! Recordings of one or two revolutions: they do not show how revolutions scatter.

use signal::Complex64;
use signal::crank_angle::CrankAngle;
use signal::order_lines::OrderLines;
use std::f64::consts::{LN_2, TAU};

/// Fewer revolutions have no noise of their own between the orders.
const ENOUGH: f64 = 3.0;
/// Share of a single revolution that may be missing.
const MISSING: f64 = 0.01;
/// Orders up to this share of half the samples per revolution are used.
const USED_ORDERS: f64 = 0.8;
/// The upper part of them is taken for noise.
const NOISE: f64 = 2.0 / 3.0;

/// Whether a recording is that short: it lacks more than one sample of as many whole revolutions.
pub(crate) fn is_short(angle: &CrankAngle) -> bool {
    angle.revolutions() < ENOUGH - 1.5 / angle.samples_per_revolution()
}

/// The lines of the whole revolutions of a channel, from its first sample on, taken as one period of
/// a motion that goes on so. None where there is not one whole revolution.
///
/// Amplitudes are Fourier integrals over the crank angle by the trapezoidal rule, which is exact for
/// samples at equal angles. The noise is taken as white. It is read at the highest third of the orders, which
/// neither the motion nor the gas reaches. Their median is used, as a tone may stand there too. Powers of
/// noise are distributed exponentially, so that their median is ln 2 times the mean. The noise is at least the
/// rounding to the channel's own resolution, q²/12 per sample.
pub(crate) fn lines(angle: &CrankAngle, samples: &[f64]) -> Option<OrderLines> {
    let whole = (angle.revolutions() + 0.5 / angle.samples_per_revolution()).floor();
    let revolutions = match whole < 1.0 {
        true => (angle.revolutions() + MISSING).floor(),
        false => whole,
    };
    let period = revolutions * TAU;
    let start = angle.angles()[0];
    // Half a sample decides whether the last one is the first of the next revolution.
    let end = start + period - 0.5 * TAU / angle.samples_per_revolution();
    let angles = angle.angles();
    let count = angles.partition_point(|a| *a < end).min(samples.len());
    if revolutions < 1.0 || count < 3 {
        return None;
    }
    let [angles, samples] = [&angles[..count], &samples[..count]];
    let width = |i: usize| {
        let after = if i + 1 < count {
            angles[i + 1]
        } else {
            angles[0] + period
        };
        let before = if i > 0 {
            angles[i - 1]
        } else {
            angles[count - 1] - period
        };
        0.5 * (after - before)
    };
    let of_order = |k: usize| -> Complex64 {
        let turned =
            |i: usize| Complex64::from_polar(width(i) * samples[i], -(k as f64) * angles[i]);
        let sum: Complex64 = (0..count).map(turned).sum();
        sum * if k == 0 { 1.0 } else { 2.0 } / period
    };
    let per_revolution = count as f64 / revolutions;
    let highest = (0.5 * USED_ORDERS * per_revolution) as usize;
    let amplitude: Vec<Complex64> = (0..=highest).map(of_order).collect();
    let first = (NOISE * highest as f64) as usize;
    let mut powers: Vec<f64> = amplitude[first.max(1)..]
        .iter()
        .map(Complex64::norm_sqr)
        .collect();
    powers.sort_by(f64::total_cmp);
    let noise = powers
        .get(powers.len() / 2)
        .map_or(0.0, |median| median / LN_2);
    let rounding = 4.0 / count as f64 * resolution(samples).powi(2) / 12.0;
    let variance = noise.max(rounding);
    Some(OrderLines {
        variance: (0..=highest)
            .map(|k| if k == 0 { 0.25 * variance } else { variance })
            .collect(),
        amplitude,
        revolutions: revolutions as usize,
    })
}

/// The least difference between two values of a channel.
fn resolution(samples: &[f64]) -> f64 {
    let mut values = samples.to_vec();
    values.sort_by(f64::total_cmp);
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
    let least = steps
        .filter(|step| *step > 0.0)
        .fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: usize = 720;

    fn channel(wave: impl Fn(f64) -> f64) -> (CrankAngle, Vec<f64>) {
        let readings: Vec<f64> = (0..COUNT).map(|i| TAU * i as f64 / COUNT as f64).collect();
        let samples = readings.iter().map(|a| wave(*a)).collect();
        (CrankAngle::from_encoder(&readings).unwrap(), samples)
    }

    #[test]
    fn one_revolution_gives_its_lines_exactly() {
        let (angle, x) = channel(|a| 3.0 + (a + 0.4).cos() + 0.01 * (170.0 * a).sin());
        assert!(is_short(&angle));
        let lines = lines(&angle, &x).unwrap();
        assert_eq!((lines.revolutions, lines.amplitude.len()), (1, 289));
        for (k, c) in lines.amplitude.iter().enumerate() {
            let expected = match k {
                0 => Complex64::new(3.0, 0.0),
                1 => Complex64::from_polar(1.0, 0.4),
                170 => Complex64::new(0.0, -0.01),
                _ => Complex64::ZERO,
            };
            assert!((c - expected).norm() < 1e-6, "order {k}: {c}");
        }
    }

    /// White noise of variance s² leaves lines of variance 4 s²/N, whether or not a tone stands among them.
    #[test]
    fn the_noise_is_that_of_the_highest_orders() {
        let mut state = 1_u64;
        let (angle, mut x) = channel(|a| 100.0 * a.cos() + 2.0 * (250.0 * a).cos());
        for x in &mut x {
            // A linear congruential generator (Knuth's MMIX): uniform from −1/2 to 1/2.
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            *x += (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        }
        let lines = lines(&angle, &x).unwrap();
        let expected = 4.0 / 12.0 / COUNT as f64;
        let found = lines.variance[1] / expected;
        assert!((0.5..2.0).contains(&found), "{found}");
        assert_eq!(lines.variance[0], 0.25 * lines.variance[1]);
    }

    #[test]
    fn rounding_alone_leaves_its_own_noise() {
        let (angle, x) = channel(|a| (10.0 * a.cos()).round());
        let lines = lines(&angle, &x).unwrap();
        assert!(lines.variance[1] >= 4.0 / 12.0 / COUNT as f64);
    }
}
