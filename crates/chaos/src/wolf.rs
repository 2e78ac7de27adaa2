//! Largest exponent after Wolf, Swift, Swinney and Vastano 1985. A neighbour is followed for a fixed
//! time, then replaced by one that lies in nearly the same direction.

use crate::blocks::{block_means, mean};
use crate::error::{Error, checked};
use crate::neighbours::{Delays, Neighbours};

/// Neighbours among which a replacement is chosen.
const CHOICE: usize = 20;
/// Nearest ones left out, whose distance noise decides.
const LEFT_OUT: usize = 3;
/// Fewest steps with a neighbour.
const FEWEST: usize = 40;

/// What following one neighbour after the other gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wolf {
    /// Largest exponent in nats per sample.
    pub value: f64,
    /// Its standard error, from successive stretches of the signal.
    pub standard_error: f64,
    /// Neighbours followed.
    pub followed: usize,
    /// Geometric mean of the distances from which neighbours were followed, and to which.
    pub from: f64,
    /// See `from`.
    pub to: f64,
}

/// Follows neighbours through the whole signal, each for `steps` samples. There is no value where
/// neighbours part to half of the distance of unrelated vectors: their growth has ended by then.
///
/// # Errors
/// A signal that [`checked`] refuses or that is too short for `delays`, `theiler` and `steps`; `steps` of 0; neighbours that
/// all coincide or that part at once.
pub fn wolf(delays: &Delays, theiler: usize, steps: usize) -> Result<Wolf, Error> {
    let (_, deviation) = checked(delays.signal)?;
    let needed = delays.span() + FEWEST * steps + 2 * theiler + CHOICE + LEFT_OUT + 1;
    let too_short = Error::TooShort {
        found: delays.signal.len(),
        needed,
    };
    if delays.signal.len() < needed || steps == 0 {
        return Err(too_short);
    }
    let count = delays.count() - steps;
    let search = Neighbours::new(delays, count, theiler).ok_or(too_short)?;
    let mut direction: Option<Vec<f64>> = None;
    let (mut before, mut after) = (Vec::new(), Vec::new());
    for index in (0..count).step_by(steps) {
        let near = search.nearest(index, CHOICE + LEFT_OUT);
        let alike = |other: usize| {
            let apart = separation(delays, index, other);
            match &direction {
                Some(d) => dot(&apart, d) / dot(&apart, &apart).sqrt(),
                None => 0.0,
            }
        };
        let chosen = (near.iter().skip(LEFT_OUT))
            .filter(|n| n.distance > 0.0)
            .max_by(|a, b| alike(a.index).total_cmp(&alike(b.index)));
        let Some(chosen) = chosen else {
            direction = None;
            continue;
        };
        let apart = separation(delays, index + steps, chosen.index + steps);
        let length = dot(&apart, &apart).sqrt();
        if length > 0.0 {
            before.push(chosen.distance.ln());
            after.push(length.ln());
            direction = Some(apart);
        }
    }
    if before.len() < FEWEST {
        return Err(Error::NoScalingRegion {
            reason: "all neighbours coincide",
        });
    }
    let growth: Vec<f64> = before.iter().zip(&after).map(|(b, a)| a - b).collect();
    let blocks = block_means(&growth);
    let value = mean(&growth);
    let spread: f64 = blocks.iter().map(|b| (b - value).powi(2)).sum();
    let found = Wolf {
        value: value / steps as f64,
        standard_error: (spread / ((blocks.len() - 1) * blocks.len()) as f64).sqrt() / steps as f64,
        followed: growth.len(),
        from: mean(&before).exp(),
        to: mean(&after).exp(),
    };
    // Unrelated vectors are sqrt(2 dimension) standard deviations apart.
    if found.to > 0.5 * (2.0 * delays.dimension as f64).sqrt() * deviation {
        return Err(Error::NoScalingRegion {
            reason: "neighbours part at once",
        });
    }
    Ok(found)
}

fn separation(delays: &Delays, a: usize, b: usize) -> Vec<f64> {
    (0..delays.dimension)
        .map(|axis| delays.at(b, axis) - delays.at(a, axis))
        .collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::{Noise, Regular, System, with_noise};

    fn followed(
        signal: &[f64],
        dimension: usize,
        delay: usize,
        steps: usize,
    ) -> Result<Wolf, Error> {
        let delays = Delays {
            signal,
            dimension,
            delay,
        };
        wolf(&delays, 10 * delay, steps)
    }

    #[test]
    fn exponents_of_chaotic_systems() {
        let henon = followed(&System::Henon.samples(5000, 1), 2, 1, 1).unwrap();
        assert!((henon.value / 0.4193 - 1.0).abs() < 0.1, "{henon:?}");
        // Wolf's method overestimates flows: it follows what grows fastest at the moment.
        let lorenz = followed(&System::Lorenz.samples(10_000, 1), 3, 4, 16).unwrap();
        let truth = System::Lorenz.exponent() * System::Lorenz.sample_interval();
        assert!((lorenz.value / truth - 1.0).abs() < 0.4, "{lorenz:?}");
    }

    #[test]
    fn neighbours_on_a_cycle_stay_and_those_of_noise_are_refused() {
        let cycle = with_noise(&Regular::Periodic.samples(3000, 1), 0.001, 1);
        let cycle = followed(&cycle, 4, 3, 12).unwrap();
        assert!(cycle.value.abs() < 0.02, "{cycle:?}");
        let noise = followed(&Noise::White.samples(3000, 1), 4, 1, 3);
        assert!(
            matches!(noise, Err(Error::NoScalingRegion { .. })),
            "{noise:?}"
        );
    }
}
