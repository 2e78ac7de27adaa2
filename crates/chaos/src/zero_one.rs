//! The 0-1 test for chaos (Gottwald and Melbourne 2009, correlation method with the oscillating
//! term removed).

use crate::error::{Error, checked};
use rand::{RngExt, SeedableRng};
use scalar::random::Stream;
use std::f64::consts::PI;

/// Frequencies tried; the median of their results is the answer.
const FREQUENCIES: usize = 100;
/// Most samples used, after thinning.
const SAMPLES: usize = 5000;

/// Near 1 for chaos (and for noise), near 0 for regular motion. Every `step`-th sample is used (0 counts
/// as 1), because finely sampled flows look regular to the test: for a flow the delay of its
/// embedding. Where a drive is known, `step` must divide its period. Otherwise the overtones of a
/// wave with impacts fold back to frequencies all over the band, which few samples cannot
/// resolve, and the wave looks like noise.
///
/// # Errors
/// A signal that [`checked`] refuses, or one of fewer than 100 samples after thinning.
pub fn zero_one(signal: &[f64], step: usize) -> Result<f64, Error> {
    let (mean, deviation) = checked(signal)?;
    let thinned: Vec<f64> = signal
        .iter()
        .step_by(step.max(1))
        .take(SAMPLES)
        .map(|x| (x - mean) / deviation)
        .collect();
    if thinned.len() < 100 {
        return Err(Error::TooShort {
            found: signal.len(),
            needed: 100 * step.max(1),
        });
    }
    let mut generator = Stream::seed_from_u64(0);
    let mut results: Vec<f64> = (0..FREQUENCIES)
        .map(|_| correlation(&thinned, generator.random_range(PI / 5.0..4.0 * PI / 5.0)))
        .collect();
    results.sort_by(f64::total_cmp);
    Ok((results[FREQUENCIES / 2 - 1] + results[FREQUENCIES / 2]) / 2.0)
}

/// Correlation of the mean square displacement at frequency `c` with time.
fn correlation(signal: &[f64], c: f64) -> f64 {
    let longest = signal.len() / 10;
    let (mut p, mut q) = (0.0, 0.0);
    let path: Vec<(f64, f64)> = signal
        .iter()
        .enumerate()
        .map(|(i, x)| {
            let (sin, cos) = (c * (i + 1) as f64).sin_cos();
            p += x * cos;
            q += x * sin;
            (p, q)
        })
        .collect();
    let origins = signal.len() - longest;
    let mean = signal.iter().sum::<f64>() / signal.len() as f64;
    let displacement: Vec<f64> = (1..=longest)
        .map(|n| {
            let square: f64 = path[..origins]
                .iter()
                .zip(&path[n..])
                .map(|(a, b)| (b.0 - a.0).powi(2) + (b.1 - a.1).powi(2))
                .sum();
            let oscillation = (1.0 - (n as f64 * c).cos()) / (1.0 - c.cos());
            square / origins as f64 - mean * mean * oscillation
        })
        .collect();
    pearson(&displacement)
}

/// Correlation of values with their index.
fn pearson(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let (middle, mean) = ((count - 1.0) / 2.0, values.iter().sum::<f64>() / count);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (i, y) in values.iter().enumerate() {
        let (dx, dy) = (i as f64 - middle, y - mean);
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    if yy > 0.0 { xy / (xx * yy).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::times;
    use crate::test_systems::{Regular, System, with_noise};

    #[test]
    fn chaos_is_one_and_order_is_zero() {
        for system in [System::Logistic, System::Henon, System::Lorenz] {
            let signal = system.samples(4000, 1);
            let k = zero_one(&signal, times(&signal).unwrap().delay).unwrap();
            assert!(k > 0.8, "{} {k}", system.name());
        }
        for regular in [Regular::Periodic, Regular::TwoTone] {
            let signal = regular.samples(4000, 1);
            let k = zero_one(&signal, times(&signal).unwrap().delay).unwrap();
            assert!(k < 0.2, "{regular:?} {k}");
        }
    }

    #[test]
    fn impacts_that_a_drive_repeats_are_order() {
        // A burst of 0.3 cycles a sample, in each period of 256, a little jittered by noise.
        let wave = |i: usize| {
            let since = (i % 256) as f64;
            (-since / 40.0).exp() * (0.3 * 2.0 * PI * since).sin()
        };
        let clean: Vec<f64> = (0..25_600).map(wave).collect();
        let signal = with_noise(&clean, 0.01, 1);
        let k = zero_one(&signal, 16).unwrap();
        assert!(k.abs() < 0.1, "{k}");
    }
}
