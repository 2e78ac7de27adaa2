//! How the crank of a recording turned: its mean speed, and how that fluctuated.

use mechanism::drive::{Fluctuation, GivenSpeed};
use signal::crank_angle::CrankAngle;
use std::f64::consts::TAU;

/// Harmonics of the speed that are kept: gas and inertia of a few throws have no higher ones that
/// a flywheel lets through.
const HARMONICS: usize = 8;
/// Rounds in which speed and harmonics are found; each leaves a small part of the error.
const ROUNDS: usize = 4;
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

/// The motion of a recorded crank: θ − φ in harmonics of φ = ω t + φ0, which turns evenly. Speed and
/// harmonics depend on each other where the recording ends within a revolution, and are found in turn.
pub(crate) fn recorded(angle: &CrankAngle, sample_rate: f64) -> GivenSpeed {
    let mut step = TAU / angle.samples_per_revolution();
    let mut fluctuation = Vec::new();
    if angle.revolutions() >= REVOLUTIONS {
        let angles = angle.angles();
        let last = angles.len() - 1;
        for _ in 0..ROUNDS {
            let even = Even::new(angles, step);
            fluctuation = (1..=HARMONICS).map(|k| even.harmonic(k)).collect();
            let turned = |i: usize| angles[i] - ahead(&fluctuation, even.angle(i));
            step = (turned(last) - turned(0)) / last as f64;
        }
    }
    GivenSpeed {
        speed: step * sample_rate,
        fluctuation,
    }
}

/// By how much a crank that fluctuates is ahead of one that turns evenly and stands at `phi`, rad.
fn ahead(fluctuation: &[Fluctuation], phi: f64) -> f64 {
    let harmonics = (1..).map(f64::from).zip(fluctuation);
    harmonics
        .map(|(k, h)| h.amplitude / k * (k * phi + h.phase).sin())
        .sum()
}

/// A recorded angle beside one that turns evenly, over whole revolutions.
struct Even<'a> {
    angles: &'a [f64],
    start: f64,
    step: f64,
}

impl<'a> Even<'a> {
    fn new(angles: &'a [f64], step: f64) -> Self {
        let revolutions = (angles.len() as f64 * step / TAU).floor();
        let count = ((revolutions * TAU / step).round() as usize).min(angles.len());
        let angles = &angles[..count];
        let apart = angles.iter().enumerate().map(|(i, a)| a - step * i as f64);
        let start = apart.sum::<f64>() / count as f64;
        Self {
            angles,
            start,
            step,
        }
    }

    fn angle(&self, i: usize) -> f64 {
        self.start + self.step * i as f64
    }

    /// (d/k) sin(k φ + ψ) = (d/k) cos ψ sin k φ + (d/k) sin ψ cos k φ.
    fn harmonic(&self, k: usize) -> Fluctuation {
        let order = k as f64;
        let share = 2.0 / self.angles.len() as f64;
        let (mut sine, mut cosine) = (0.0, 0.0);
        for (i, angle) in self.angles.iter().enumerate() {
            let (s, c) = (order * self.angle(i)).sin_cos();
            sine += share * s * (angle - self.angle(i));
            cosine += share * c * (angle - self.angle(i));
        }
        Fluctuation {
            amplitude: order * sine.hypot(cosine),
            phase: cosine.atan2(sine),
        }
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
