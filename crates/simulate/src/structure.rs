//! The structure between what acts and the foot of a sensor: an oscillator.
//!
//! The sensor reads of the motion what drives the oscillator, a force per mass, m/s². What it records is the
//! oscillator's response, with H over the circular frequency w:
//!
//! ```text
//! acceleration   H = -w²/(ω² - w² + 2i ζ ω w)
//! velocity       H = i w/(ω² - w² + 2i ζ ω w)
//! ```

use nalgebra::Complex;
use signal::biquad::Filter;
use std::f64::consts::TAU;

/// What is left of the oscillator's own swinging where its record begins: 80 dB below.
const LEFT: f64 = 1e-4;

/// A damped oscillator, and a second-order resonance with gain 1 at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Natural frequency, Hz.
    pub frequency: f64,
    /// Damping ratio ζ.
    pub damping_ratio: f64,
}

/// An oscillator, and what of it is recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Structure {
    /// How it swings.
    pub resonance: Resonance,
    /// What is recorded.
    pub shows: Shows,
}

/// What of an oscillator is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shows {
    /// Its acceleration, m/s².
    Acceleration,
    /// Its velocity, m/s.
    Velocity,
}

impl Structure {
    /// The response to a steady drive at a circular frequency, rad/s.
    pub fn response(&self, frequency: f64) -> Complex<f64> {
        let own = TAU * self.resonance.frequency;
        let ratio = frequency / own;
        let below = Complex::new(
            1.0 - ratio * ratio,
            2.0 * self.resonance.damping_ratio * ratio,
        );
        match self.shows {
            Shows::Acceleration => -ratio * ratio / below,
            Shows::Velocity => Complex::new(0.0, ratio / own) / below,
        }
    }

    /// How long its own swinging takes to decay, s: as exp(−ζωt), and beyond critical damping as the slower of its two
    /// exponentials, exp(−(ζ − √(ζ² − 1))ωt).
    pub(crate) fn settling(&self) -> f64 {
        let Resonance {
            frequency,
            damping_ratio,
        } = self.resonance;
        let beyond = (damping_ratio * damping_ratio - 1.0).max(0.0).sqrt();
        // (ζ − √(ζ² − 1)) without its cancellation.
        let decay = match beyond > 0.0 {
            true => 1.0 / (damping_ratio + beyond),
            false => damping_ratio,
        };
        -LEFT.ln() / (decay * TAU * frequency)
    }

    /// The filter that is its response, at this rate, Hz.
    pub(crate) fn filter(&self, rate: f64) -> Result<Filter, signal::Error> {
        let Resonance {
            frequency,
            damping_ratio,
        } = self.resonance;
        match self.shows {
            Shows::Acceleration => Filter::accelerance(frequency, damping_ratio, rate),
            Shows::Velocity => Filter::mobility(frequency, damping_ratio, rate),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is left of a velocity after the time that it takes to settle, by the exact solution of the free oscillator.
    #[test]
    fn little_is_left_after_settling() {
        for damping_ratio in [0.05, 0.9, 1.0, 1.1, 6.0] {
            let resonance = Resonance {
                frequency: 10.0,
                damping_ratio,
            };
            let shows = Shows::Acceleration;
            let settling = Structure { resonance, shows }.settling();
            let own = TAU * resonance.frequency;
            let root = Complex::new(damping_ratio * damping_ratio - 1.0, 0.0).sqrt();
            let slow = (own * (root - damping_ratio) * settling).exp().norm();
            assert!(
                (0.99 * LEFT..1.01 * LEFT).contains(&slow),
                "{damping_ratio}: {slow:e}"
            );
        }
    }
}
