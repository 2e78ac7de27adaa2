//! The state once a revolution, kept to see whether it repeats.

use crate::flow::{Cycle, Flow};
use crate::tangents::Tangents;
use integrate::{Real, Step, System};
use std::collections::VecDeque;

/// Longest period that is looked for, revolutions.
const LONGEST_PERIOD: usize = 16;
/// States that are kept: every one is compared with the one a period earlier.
const KEPT: usize = 3 * LONGEST_PERIOD;
/// Where in the revolution the state is taken.
const PHASE: f64 = 0.31;
/// Steps of the search for the crossing. A crank's speed varies by a few per cent, so each gains
/// one digit at least.
const SEARCH: usize = 12;

/// The states of the last revolutions, each component over its scale.
pub(crate) struct Strobes {
    cycle: Cycle,
    scales: Vec<f64>,
    states: VecDeque<Vec<f64>>,
}

impl Strobes {
    pub fn new<F: Flow, const N: usize>(tangents: &Tangents<F, N>) -> Self {
        Self {
            cycle: tangents.cycle(),
            scales: tangents.scales().to_vec(),
            states: VecDeque::new(),
        }
    }

    /// Keeps the state in `step` at which the cycle's angle passes the phase.
    pub fn watch<S: Real>(&mut self, system: &mut impl System<S>, step: &mut Step<S>) {
        let (start, length) = (step.start.value(), step.length.value());
        let turns = |share: f64, y: &[S]| self.cycle.turns(start + share * length, y) - PHASE;
        let (before, after) = (turns(0.0, &step.from), turns(1.0, &step.to));
        if before.floor() == after.floor() {
            return;
        }
        step.extend(system);
        let mut share = 0.0;
        let mut state = step.from.clone();
        for _ in 0..SEARCH {
            let missing = after.floor() - turns(share, &state);
            share += missing / (after - before);
            step.interpolate(S::constant(share), &mut state);
        }
        let scaled = state.iter().zip(&self.scales);
        let mut scaled: Vec<f64> = scaled.map(|(y, scale)| y.value() / scale).collect();
        if let Some(i) = self.cycle.free {
            // The angle is the same every time; how far it has strayed from a clock means nothing.
            scaled[i] = 0.0;
        }
        if self.states.len() == KEPT {
            self.states.pop_front();
        }
        self.states.push_back(scaled);
    }

    /// The periods, in revolutions, after which the state comes back to within `distance`, every
    /// time of the last two periods; the shortest first.
    pub fn periods(&self, distance: f64) -> impl Iterator<Item = usize> {
        (1..=LONGEST_PERIOD).filter(move |&period| {
            let last = self.states.iter().rev();
            let earlier = self.states.iter().rev().skip(period);
            let mut pairs = last.zip(earlier).take(2 * period);
            pairs.len() == 2 * period && pairs.all(|(a, b)| furthest(a, b) < distance)
        })
    }
}

/// Largest difference of two states.
fn furthest(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
