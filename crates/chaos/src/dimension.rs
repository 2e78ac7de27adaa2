//! Dimension to embed with.

use crate::delay::Times;
use crate::error::{Error, checked};
use crate::neighbours::{Delays, LARGEST_DIMENSION, Neighbours};

/// Share of false neighbours below which the attractor counts as unfolded.
const FALSE_SHARE: f64 = 0.01;
/// Vectors at which neighbours are examined, at most.
const EXAMINED: usize = 2000;
/// Increase of Cao's quotient that counts as none.
const SATURATED: f64 = 0.05;

/// Shares of false nearest neighbours and Cao's quantities for dimensions 1, 2, ... as far as they were examined.
#[derive(Clone, Debug, PartialEq)]
pub struct Unfolding {
    /// Share of nearest neighbours that part with one more coordinate (Kennel, Brown and
    /// Abarbanel 1992; ratio 15, size 2).
    pub false_share: Vec<f64>,
    /// `E1(d) = E(d+1) / E(d)` (Cao 1997).
    pub e1: Vec<f64>,
    /// `E2(d)`: near 1 in every dimension for a random signal (Cao 1997).
    pub e2: Vec<f64>,
}

impl Unfolding {
    /// What these dimensions say, the last of which is compared with the one before only.
    fn of(steps: &[Step]) -> Self {
        let quotients = |value: fn(&Step) -> f64| -> Vec<f64> {
            steps
                .windows(2)
                .map(|s| value(&s[1]) / value(&s[0]).max(f64::MIN_POSITIVE))
                .collect()
        };
        Self {
            false_share: steps[..steps.len() - 1]
                .iter()
                .map(|s| s.false_share)
                .collect(),
            e1: quotients(|s| s.expansion),
            e2: quotients(|s| s.parting),
        }
    }

    /// Smallest dimension without false neighbours; `None` where noise leaves some in each.
    pub fn by_false_neighbours(&self) -> Option<usize> {
        self.false_share
            .iter()
            .position(|s| *s < FALSE_SHARE)
            .map(|d| d + 1)
    }

    /// Smallest dimension after which `E1` no longer rises.
    pub fn by_cao(&self) -> Option<usize> {
        self.e1
            .windows(2)
            .position(|e| e[1] - e[0] < SATURATED && e[0] > 0.8)
            .map(|d| d + 1)
    }

    /// The dimension to embed with: the larger of both, or the one that there is, or the largest
    /// examined.
    pub fn dimension(&self) -> usize {
        match (self.by_false_neighbours(), self.by_cao()) {
            (Some(a), Some(b)) => a.max(b),
            (Some(d), None) | (None, Some(d)) => d,
            (None, None) => self.false_share.len(),
        }
    }
}

/// What each further coordinate does to nearest neighbours, until both criteria have found a dimension, and up to
/// `largest` coordinates.
///
/// # Errors
/// A signal that [`checked`] refuses or that is too short for `largest` and `times`, or a `largest` outside 1 to
/// [`LARGEST_DIMENSION`] − 1.
pub fn unfolding(signal: &[f64], times: &Times, largest: usize) -> Result<Unfolding, Error> {
    let (_, deviation) = checked(signal)?;
    if !(1..LARGEST_DIMENSION).contains(&largest) {
        return Err(Error::Setting {
            name: "largest dimension",
            value: largest,
            low: 1,
            high: LARGEST_DIMENSION - 1,
        });
    }
    let needed = (largest + 1) * times.delay + 2 * times.theiler + 50;
    if signal.len() < needed {
        return Err(Error::TooShort {
            found: signal.len(),
            needed,
        });
    }
    let mut steps = Vec::new();
    for dimension in 1..=largest + 1 {
        let delays = Delays {
            signal,
            dimension,
            delay: times.delay,
        };
        steps.push(step(&delays, times, deviation));
        let so_far = Unfolding::of(&steps);
        if so_far.by_false_neighbours().is_some() && so_far.by_cao().is_some() {
            return Ok(so_far);
        }
    }
    Ok(Unfolding::of(&steps))
}

/// One dimension: the share of false neighbours, Cao's `E` and `E*`.
struct Step {
    false_share: f64,
    expansion: f64,
    parting: f64,
}

fn step(delays: &Delays, times: &Times, deviation: f64) -> Step {
    let count = delays.signal.len() - delays.dimension * delays.delay;
    let mut step = Step {
        false_share: 0.0,
        expansion: 0.0,
        parting: 0.0,
    };
    let Some(neighbours) = Neighbours::new(delays, count, times.theiler) else {
        return step;
    };
    let mut examined = 0.0;
    let every = count.div_ceil(EXAMINED);
    for (place, near) in neighbours.nearest_of_each(every).into_iter().enumerate() {
        // Vectors that repeat exactly say nothing (Cao 1997).
        let Some(near) = near.filter(|n| n.distance > 0.0) else {
            continue;
        };
        let index = place * every;
        let further =
            (delays.at(index, delays.dimension) - delays.at(near.index, delays.dimension)).abs();
        let whole = near.distance.hypot(further);
        let parts = further > 15.0 * near.distance || whole > 2.0 * deviation;
        step.false_share += f64::from(u8::from(parts));
        let widest = (0..delays.dimension)
            .map(|axis| (delays.at(index, axis) - delays.at(near.index, axis)).abs())
            .fold(f64::MIN_POSITIVE, f64::max);
        step.expansion += further.max(widest) / widest;
        step.parting += further;
        examined += 1.0;
    }
    if examined > 0.0 {
        step.false_share /= examined;
        step.expansion /= examined;
        step.parting /= examined;
    }
    step
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::times;
    use crate::test_systems::{Noise, System};

    fn unfolding_of(signal: &[f64]) -> Unfolding {
        unfolding(signal, &times(signal).unwrap(), 8).unwrap()
    }

    #[test]
    fn dimensions_of_known_systems() {
        // The logistic map needs 1 coordinate, Hénon 2, Lorenz and Rössler 3.
        assert_eq!(
            unfolding_of(&System::Logistic.samples(4000, 1)).by_false_neighbours(),
            Some(1)
        );
        assert_eq!(
            unfolding_of(&System::Henon.samples(4000, 1)).by_false_neighbours(),
            Some(2)
        );
        for system in [System::Lorenz, System::Roessler] {
            let unfolding = unfolding_of(&system.samples(8000, 1));
            let dimension = unfolding.by_false_neighbours();
            assert!(
                matches!(dimension, Some(3 | 4)),
                "{} {unfolding:?}",
                system.name()
            );
        }
    }

    #[test]
    fn white_noise_does_not_unfold() {
        let unfolding = unfolding_of(&Noise::White.samples(4000, 1));
        assert!(
            unfolding.e2.iter().all(|e| (e - 1.0).abs() < 0.1),
            "{unfolding:?}"
        );
        let henon = unfolding_of(&System::Henon.samples(4000, 1));
        assert!(henon.e2.iter().any(|e| (e - 1.0).abs() > 0.2), "{henon:?}");
    }

    #[test]
    fn too_short_a_signal_is_refused() {
        let signal = System::Henon.samples(100, 1);
        let times = Times {
            delay: 9,
            ..times(&signal).unwrap()
        };
        assert!(matches!(
            unfolding(&signal, &times, 8),
            Err(Error::TooShort { .. })
        ));
        assert!(matches!(
            unfolding(&signal, &times, 10),
            Err(Error::Setting { .. })
        ));
    }
}
