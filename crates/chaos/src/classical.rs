//! The classical estimates of the largest exponent, each with settings found from the signal:
//! second opinions beside [`crate::exponent`], and what other tools print.

use crate::delay::Times;
use crate::dimension::unfolding;
use crate::divergence::{Curve, kantz, rosenstein};
use crate::error::Error;
use crate::neighbours::Delays;
use crate::scaling_region::{Fit, scaling_region};
use crate::wolf::{Wolf, wolf};

/// Largest dimension to embed with.
const LARGEST: usize = 7;
/// Neighbours of each vector for Kantz's curve.
const NEIGHBOURS: usize = 10;
/// Longest curve in mean periods, and as a share of the signal.
const PERIODS: f64 = 10.0;
const SHARE: usize = 10;

/// A divergence curve and its scaling region, or why it has no such region.
#[derive(Clone, Debug, PartialEq)]
pub struct Divergence {
    /// Mean logarithm of the distance (nats) against samples.
    pub curve: Curve,
    /// The straight part; its slope is the exponent in nats per sample.
    pub region: Result<Fit, Error>,
}

/// The three classical estimates and the dimension they were made in.
#[derive(Clone, Debug, PartialEq)]
pub struct Classical {
    /// Coordinates of the delay vectors.
    pub dimension: usize,
    /// After Rosenstein, Collins and De Luca 1993.
    pub rosenstein: Divergence,
    /// After Kantz 1994.
    pub kantz: Divergence,
    /// After Wolf, Swift, Swinney and Vastano 1985, each neighbour followed for four delays,
    /// about a period (one sample of a map).
    pub wolf: Result<Wolf, Error>,
}

/// All three, embedded with the delay of `times` in the dimension of [`unfolding`].
///
/// # Errors
/// A signal that [`unfolding`] refuses, or that is too short for the divergence curves. A curve without a
/// scaling region is no error: it is part of the result.
pub fn classical(signal: &[f64], times: &Times) -> Result<Classical, Error> {
    let dimension = unfolding(signal, times, LARGEST)?.dimension();
    let delays = Delays {
        signal,
        dimension,
        delay: times.delay,
    };
    let longest = (signal.len() / SHARE) as f64;
    let steps = (PERIODS * times.mean_period).min(longest) as usize;
    // Before one span has gone by, a curve bends while neighbours turn to the unstable direction.
    let skip = delays.span();
    let fitted = |curve: Curve| Divergence {
        region: scaling_region(&curve, skip),
        curve,
    };
    let evolved = if times.delay == 1 { 1 } else { 4 * times.delay };
    Ok(Classical {
        dimension,
        rosenstein: fitted(rosenstein(&delays, times.theiler, steps)?),
        kantz: fitted(kantz(&delays, times.theiler, steps, NEIGHBOURS)?),
        wolf: wolf(&delays, times.theiler, evolved),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::times;
    use crate::test_systems::{Noise, System};

    #[test]
    fn all_three_find_lorenz_roughly() {
        let signal = System::Lorenz.samples(8000, 1);
        let found = classical(&signal, &times(&signal).unwrap()).unwrap();
        let truth = System::Lorenz.exponent() * System::Lorenz.sample_interval();
        let values = [
            (found.rosenstein.region.unwrap().slope, 0.25),
            (found.kantz.region.unwrap().slope, 0.25),
            (found.wolf.unwrap().value, 0.4),
        ];
        for (value, tolerance) in values {
            let error = value / truth - 1.0;
            assert!(error.abs() < tolerance, "{values:?} {truth}");
        }
    }

    #[test]
    fn white_noise_has_no_scaling_region() {
        let signal = Noise::White.samples(3000, 1);
        let found = classical(&signal, &times(&signal).unwrap()).unwrap();
        assert!(found.rosenstein.region.is_err() && found.kantz.region.is_err());
        assert!(found.wolf.is_err());
    }
}
