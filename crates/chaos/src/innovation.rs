//! Does what differs from cycle to cycle follow from what was, or does chance enter at some phase?
//!
//! The state of a deterministic system at any phase of its drive decides what follows (Stark 1999). So
//! cycles that are alike before a phase stay alike after it, at every phase. A load, a timing or an
//! amplitude that chance gives to each cycle makes cycles alike too, but only from the phase on at which
//! it is given. There, the past says of the future no more than a linear process would. One such phase
//! is enough for chance to be at work; so the signal must differ from its surrogates at every phase.
//!
//! There are two kinds of surrogates:
//!
//! - Futures exchanged between cycles keep all that holds within a cycle's part.
//! - Cycles whose Fourier components (over cycles) have new phases, the same at every
//!   phase of the drive (Prichard and Theiler 1994), keep all covariances within and between cycles. They are a
//!   cyclostationary linear Gaussian process, as slowly changing loads and ringing resonances are.

use crate::delay::Times;
use crate::neighbours::Delays;
use crate::surrogates::{Comparison, phases_randomised_alike, shuffle};
use rand::SeedableRng;
use scalar::random::Stream;

/// Phases at which the past is compared with the future.
const PHASES: usize = 12;
/// Part of a cycle that is compared, before and after a phase: the windows of neighbouring phases
/// nearly touch. And fewest samples of it, for a state of few coordinates.
const PART: usize = 10;
const FEWEST: usize = 3;
/// Quarters of a cycle after which the future is compared: right after the phase, and a quarter of a cycle later, where
/// weak chaos has had time to show that it is not linear.
const LATER: [usize; 2] = [0, 1];
/// Neighbours of each cycle.
const NEIGHBOURS: usize = 2;
/// Most cycles that are compared; each with each.
const MOST_CYCLES: usize = 256;
/// Surrogates of each kind, and the one-sided 0.1 % quantile of Student's t for the prediction of one
/// more value from that many: each phase must differ for itself.
const SURROGATES: usize = 20;
const QUANTILE: f64 = 3.579;
/// The one-sided 5 % quantile: a signal that differs from its surrogates by less at some phase is one of
/// them. Between both quantiles it is left open.
const ORDINARY: f64 = 1.729;
/// Surrogates after which a signal that is no better than their mean at some phase is given up.
const FIRST: usize = 5;

/// Compares the signal (without its mean cycle) with its surrogates, at the phase at which it differs
/// least. `None` where there are too few cycles.
pub(crate) fn determinism(residual: &[f64], per_cycle: usize) -> Option<Comparison> {
    let cycles = (residual.len() / per_cycle).min(MOST_CYCLES);
    let residual = &residual[..cycles * per_cycle];
    let own = Profile::new(residual, per_cycle)?;
    let mut generator = Stream::seed_from_u64(0);
    let exchanged = least(&own.kept(), || own.exchanged(&mut generator))?;
    if exchanged <= 0.0 {
        return Some(judged(exchanged));
    }
    let linear = least(&own.kept(), || {
        let other = phases_randomised_alike(residual, per_cycle, &mut generator);
        Profile::new(&other, per_cycle).map(|profile| profile.kept())
    })?;
    Some(judged(exchanged.min(linear)))
}

fn judged(deviations: f64) -> Comparison {
    Comparison {
        deviations,
        significant: is_clear(deviations),
    }
}

fn is_clear(deviations: f64) -> bool {
    deviations > QUANTILE * (1.0 + 1.0 / SURROGATES as f64).sqrt()
}

/// Whether a signal differs from its surrogates as little as they do from each other.
pub(crate) fn is_ordinary(deviations: f64) -> bool {
    deviations < ORDINARY * (1.0 + 1.0 / SURROGATES as f64).sqrt()
}

/// Whether at some phase the past says nothing of the future: exchanged futures do as well.
pub(crate) fn chance_enters(residual: &[f64], per_cycle: usize) -> bool {
    let cycles = (residual.len() / per_cycle).min(MOST_CYCLES);
    let own = Profile::new(&residual[..cycles * per_cycle], per_cycle);
    let mut generator = Stream::seed_from_u64(0);
    let exchanged = own.and_then(|own| least(&own.kept(), || own.exchanged(&mut generator)));
    !exchanged.is_some_and(is_clear)
}

/// Halvings of the states of a signal without a drive: so many times two cells stand for the phases.
const HALVINGS: usize = 3;
/// Coordinates of such a state, and most states that are compared, each with each of its cell.
const COORDINATES: usize = 4;
const MOST_STATES: usize = 4096;

/// Whether there are states of a signal without a known drive from which chance goes on. That is a cell of alike
/// states in which those most alike have futures no more alike than others of the cell.
pub(crate) fn chance_enters_a_cell(signal: &[f64], times: &Times) -> bool {
    let delays = Delays {
        signal,
        dimension: COORDINATES,
        delay: times.delay,
    };
    let count = delays.count().saturating_sub(times.delay).min(MOST_STATES);
    let mut cells = vec![(0..count).collect::<Vec<usize>>()];
    for _ in 0..HALVINGS {
        cells = cells
            .into_iter()
            .flat_map(|cell| halves(&delays, cell))
            .collect();
    }
    let mut generator = Stream::seed_from_u64(0);
    cells.iter().any(|cell| {
        let future = |index: usize| delays.at(index, COORDINATES);
        let near: Vec<Option<usize>> = cell
            .iter()
            .map(|a| nearest(&delays, *a, cell, times.theiler))
            .collect();
        let kept = |order: &[usize]| {
            let pairs = near
                .iter()
                .zip(order)
                .filter_map(|(near, a)| near.map(|b| (*a, order[b])));
            let (mut sum, mut count) = (0.0, 0.0);
            for (a, b) in pairs {
                let apart = (future(cell[a]) - future(cell[b])).abs();
                sum -= apart.max(f64::MIN_POSITIVE).ln().max(-30.0);
                count += 1.0;
            }
            sum / f64::max(count, 1.0)
        };
        let identity: Vec<usize> = (0..cell.len()).collect();
        let found = least(&[kept(&identity)], || {
            let mut order = identity.clone();
            shuffle(&mut order, &mut generator);
            Some(vec![kept(&order)])
        });
        !found.is_some_and(is_clear)
    })
}

/// A cell cut at the median of its widest coordinate.
fn halves(delays: &Delays, mut cell: Vec<usize>) -> [Vec<usize>; 2] {
    let spread = |axis: usize| {
        let values = cell.iter().map(|i| delays.at(*i, axis));
        let mean = values.clone().sum::<f64>() / cell.len().max(1) as f64;
        values.map(|x| (x - mean).powi(2)).sum::<f64>()
    };
    let widest = (0..COORDINATES)
        .max_by(|a, b| spread(*a).total_cmp(&spread(*b)))
        .unwrap_or(0);
    let middle = cell.len() / 2;
    if middle > 0 {
        cell.select_nth_unstable_by(middle, |a, b| {
            delays.at(*a, widest).total_cmp(&delays.at(*b, widest))
        });
    }
    let upper = cell.split_off(middle);
    [cell, upper]
}

/// Place in its cell of the state most like that of index `a`, outside the window of `theiler` samples.
fn nearest(delays: &Delays, a: usize, cell: &[usize], theiler: usize) -> Option<usize> {
    (0..cell.len())
        .filter(|place| cell[*place].abs_diff(a) > theiler)
        .map(|place| (delays.squared_distance(a, cell[place]), place))
        .min_by(|x, y| x.0.total_cmp(&y.0))
        .map(|(_, place)| place)
}

/// By how many standard deviations among the surrogates the signal's own value is larger, at the phase
/// where it is least so.
fn least(own: &[f64], mut surrogate: impl FnMut() -> Option<Vec<f64>>) -> Option<f64> {
    let mut others: Vec<Vec<f64>> = Vec::new();
    let mut found = 0.0;
    for count in [FIRST, SURROGATES] {
        while others.len() < count {
            others.push(surrogate()?);
        }
        let at = |phase: usize| {
            let values = others.iter().map(|other| other[phase]);
            let mean = values.clone().sum::<f64>() / count as f64;
            let square = values.map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1) as f64;
            (own[phase] - mean) / square.sqrt().max(1e-12)
        };
        found = (0..own.len()).map(at).fold(f64::INFINITY, f64::min);
        if found <= 0.0 {
            break;
        }
    }
    Some(found)
}

/// At each phase, who is alike before it, and how far cycles are apart after it.
struct Profile {
    phases: Vec<Phase>,
}

struct Phase {
    /// The cycles that were most like each cycle before the phase.
    near: Vec<Vec<usize>>,
    /// Logarithm of the distance of each two cycles after it, row after row.
    apart: Vec<f64>,
}

impl Profile {
    fn new(residual: &[f64], per_cycle: usize) -> Option<Self> {
        let width = (per_cycle / PART).max(FEWEST);
        let reach = LATER
            .map(|part| per_cycle * part / 4)
            .map(|later| later + width);
        let reach = reach.into_iter().max()?;
        let phases = (0..PHASES).map(|p| {
            let first = width + p * per_cycle / PHASES;
            let count = (residual.len().checked_sub(first + reach)? / per_cycle) + 1;
            (count > 2 * NEIGHBOURS)
                .then(|| Phase::new(&residual[first - width..], per_cycle, width, count))
        });
        Some(Self {
            phases: phases.collect::<Option<_>>()?,
        })
    }

    /// At each phase, how much closer than any two cycles those are which were alike: mean difference
    /// of the logarithms.
    fn kept(&self) -> Vec<f64> {
        let identity = |phase: &Phase| (0..phase.near.len()).collect::<Vec<_>>();
        self.phases.iter().map(|p| p.kept(&identity(p))).collect()
    }

    /// The same with the futures exchanged between cycles.
    fn exchanged(&self, generator: &mut Stream) -> Option<Vec<f64>> {
        let shuffled = |phase: &Phase| {
            let mut order: Vec<usize> = (0..phase.near.len()).collect();
            shuffle(&mut order, generator);
            phase.kept(&order)
        };
        Some(self.phases.iter().map(shuffled).collect())
    }
}

impl Phase {
    /// From a signal that begins with the past of the first cycle.
    fn new(signal: &[f64], per_cycle: usize, width: usize, count: usize) -> Self {
        let distance = |a: usize, b: usize| -> f64 {
            let pairs = signal[a..a + width].iter().zip(&signal[b..]);
            pairs.map(|(x, y)| (x - y).powi(2)).sum()
        };
        let mut past = vec![f64::INFINITY; count * count];
        let mut apart = vec![0.0; count * count];
        for a in 0..count {
            for b in 0..a {
                let (start, other) = (a * per_cycle, b * per_cycle);
                let before = distance(start, other);
                let after = LATER.map(|part| {
                    let later = width + per_cycle * part / 4;
                    let square = distance(start + later, other + later);
                    0.5 * square.max(f64::MIN_POSITIVE).ln() / LATER.len() as f64
                });
                let after = after.iter().sum();
                for place in [a * count + b, b * count + a] {
                    past[place] = before;
                    apart[place] = after;
                }
            }
        }
        let near = past.chunks_exact(count).map(|row| {
            let mut others: Vec<usize> = (0..count).collect();
            others.select_nth_unstable_by(NEIGHBOURS - 1, |&a, &b| row[a].total_cmp(&row[b]));
            others.truncate(NEIGHBOURS);
            others
        });
        Self {
            near: near.collect(),
            apart,
        }
    }

    fn kept(&self, order: &[usize]) -> f64 {
        let count = order.len();
        let pairs = (count * NEIGHBOURS) as f64;
        let near: f64 = self
            .near
            .iter()
            .enumerate()
            .map(|(a, others)| {
                let row = &self.apart[order[a] * count..][..count];
                others.iter().map(|b| row[order[*b]]).sum::<f64>()
            })
            .sum();
        let all = self.apart.iter().sum::<f64>() / (count * (count - 1)) as f64;
        all - near / pairs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forced::residual;
    use crate::test_systems::{Machine, Memory, System, with_noise};

    #[test]
    fn chance_in_every_cycle_is_not_determinism() {
        for machine in Machine::ALL {
            for memory in Memory::ALL {
                let signal = machine.samples(60, 60, 0.1, memory, 1);
                let found = determinism(&residual(&signal, 60), 60).unwrap();
                assert!(!found.significant, "{machine:?} {memory:?} {found:?}");
            }
        }
    }

    #[test]
    fn a_chaotic_oscillator_is_determined_at_every_phase() {
        // Duffing's oscillator has 20 samples in a period of its drive.
        let signal = with_noise(&System::Duffing.samples(4000, 1), 0.01, 1);
        let found = determinism(&residual(&signal, 20), 20).unwrap();
        assert!(found.significant, "{found:?}");
    }
}
