//! The crank angle from the pulses of a tacho.

use crate::error::Error;
use std::f64::consts::TAU;

/// A pulse begins where the signal rises through the middle of its range, having been in the lowest
/// quarter since the pulse before. Noise of a quarter of the range makes no pulse.
const ARMED: f64 = 0.25;
const RISEN: f64 = 0.5;

/// The crank angle at every sample, rad, from pulses that come once per revolution. It is 0 at the first
/// pulse, in a straight line from one to the next, and going on as fast at both ends.
///
/// # Errors
/// A sample that is not finite, or fewer than two pulses.
pub fn from_pulses(signal: &[f64]) -> Result<Vec<f64>, Error> {
    if let Some(index) = signal.iter().position(|x| !x.is_finite()) {
        return Err(Error::NotFinite { index });
    }
    let pulses = pulses(signal);
    if pulses.len() < 2 {
        return Err(Error::TooFewPulses { got: pulses.len() });
    }
    let intervals = pulses.len() - 1;
    let angle = |i: usize| {
        let at = i as f64;
        let interval = pulses.partition_point(|p| *p <= at).clamp(1, intervals);
        let [from, to] = [pulses[interval - 1], pulses[interval]];
        TAU * ((interval - 1) as f64 + (at - from) / (to - from))
    };
    Ok((0..signal.len()).map(angle).collect())
}

/// Where pulses begin, in samples with their fraction.
fn pulses(signal: &[f64]) -> Vec<f64> {
    let least = signal.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = signal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let level = |share: f64| least + share * (greatest - least);
    let mut armed = false;
    let mut pulses = Vec::new();
    for (i, x) in signal.iter().enumerate() {
        if *x < level(ARMED) {
            armed = true;
        } else if armed && *x >= level(RISEN) {
            armed = false;
            let before = signal[i - 1];
            pulses.push(i as f64 - (x - level(RISEN)) / (x - before));
        }
    }
    pulses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_tell_the_angle_between_them() {
        // A pulse of 5 samples every 100.5 samples, from 30 on.
        let signal: Vec<f64> = (0..1000)
            .map(|i| {
                let since = (f64::from(i) - 30.0).rem_euclid(100.5);
                if f64::from(i) >= 30.0 && since < 5.0 {
                    5.0
                } else {
                    0.1
                }
            })
            .collect();
        let angle = from_pulses(&signal).unwrap();
        for (i, angle) in angle.iter().enumerate() {
            let truth = TAU * (i as f64 - 29.5) / 100.5;
            // A pulse is found to a sample.
            assert!((angle - truth).abs() < TAU / 100.0, "{i}: {angle} {truth}");
        }
    }

    #[test]
    fn signals_without_pulses_are_named() {
        let still = from_pulses(&[0.0; 50]);
        assert_eq!(still, Err(Error::TooFewPulses { got: 0 }));
        assert_eq!(from_pulses(&[]), Err(Error::TooFewPulses { got: 0 }));
        let gap = from_pulses(&[0.0, f64::NAN, 1.0]);
        assert_eq!(gap, Err(Error::NotFinite { index: 1 }));
    }
}
