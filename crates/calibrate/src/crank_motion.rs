//! How the crank of a recording turned: its mean speed, and how that fluctuated.

use mechanism::drive::{Fluctuation, GivenSpeed};
use signal::crank_angle::CrankAngle;
use std::f64::consts::TAU;

/// Harmonics of the speed that are kept: gas and inertia of a few throws have no higher ones that
/// a flywheel lets through.
const HARMONICS: usize = 8;
/// Recordings shorter than this say nothing of what repeats from revolution to revolution.
const REVOLUTIONS: f64 = 2.0;

/// What turns the crank of a simulated run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CrankMotion {
    /// The machine's drive.
    #[default]
    Driven,
    /// Nothing: it turns as it was recorded.
    Recorded,
}

/// The motion of a recorded crank: the mean over whole revolutions of θ − φ, where φ = ω t turns
/// evenly, in harmonics of φ.
pub(crate) fn recorded(angle: &CrankAngle, sample_rate: f64) -> GivenSpeed {
    let angles = angle.angles();
    let per_revolution = angle.samples_per_revolution();
    let step = TAU / per_revolution;
    let speed = step * sample_rate;
    if angle.revolutions() < REVOLUTIONS {
        return GivenSpeed {
            speed,
            fluctuation: Vec::new(),
        };
    }
    let count = (angle.revolutions().floor() * per_revolution).round() as usize;
    let angles = &angles[..count.min(angles.len())];
    let ahead = |i: usize| angles[i] - step * i as f64;
    let start = (0..angles.len()).map(ahead).sum::<f64>() / angles.len() as f64;
    let share = 2.0 / angles.len() as f64;
    let fluctuation = (1..=HARMONICS).map(|k| {
        let order = k as f64;
        let (mut sine, mut cosine) = (0.0, 0.0);
        for i in 0..angles.len() {
            let (s, c) = (order * (start + step * i as f64)).sin_cos();
            sine += share * s * (ahead(i) - start);
            cosine += share * c * (ahead(i) - start);
        }
        // (d/k) sin(k φ + ψ) = (d/k) cos ψ sin k φ + (d/k) sin ψ cos k φ.
        Fluctuation {
            amplitude: order * sine.hypot(cosine),
            phase: cosine.atan2(sine),
        }
    });
    GivenSpeed {
        speed,
        fluctuation: fluctuation.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn harmonics_are_found_in_the_readings_of_an_encoder() {
        let rate = 20_000.0;
        let speed = 52.0;
        let count = TAU / 65_536.0;
        let readings: Vec<f64> = (0..30_000)
            .map(|i| {
                let phi = 0.7 + speed * f64::from(i) / rate;
                let angle = phi + 0.004 * (phi + 0.3).sin() + 0.001 / 2.0 * (2.0 * phi - 2.0).sin();
                (angle.rem_euclid(TAU) / count).floor() * count
            })
            .collect();
        let found = recorded(&CrankAngle::from_encoder(&readings).unwrap(), rate);
        assert!((found.speed / speed - 1.0).abs() < 1e-4, "{}", found.speed);
        let expected = [(0.004, 0.3), (0.001, -2.0)];
        for (found, (amplitude, phase)) in found.fluctuation.iter().zip(expected) {
            assert!((found.amplitude - amplitude).abs() < 2e-5, "{found:?}");
            assert!((found.phase - phase).abs() < 0.02, "{found:?}");
        }
        assert!(found.fluctuation[2..].iter().all(|h| h.amplitude < 5e-5));
    }
}
