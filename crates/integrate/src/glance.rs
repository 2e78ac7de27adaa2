//! The guards as the stages of a step show them: where none comes near to zero there, there is no
//! need to look into the step.
//!
//! A stage is evaluated at a state near to the solution at its node, and the last two at the
//! solution at the step's end. That costs nothing more, where a look at the continuous extension
//! takes three derivatives for the extension and one more for each look.

use crate::dop853::Step;
use crate::system::{Real, System};

/// Stages that are looked at, beside the beginning.
const STAGES: [usize; 4] = [6, 9, 10, 12];
/// Where in the step they and the beginning lie.
const SHARES: [f64; STAGES.len() + 1] = [0.0, 0.25, 0.6, 6.0 / 7.0, 1.0];
/// A guard is near to zero below this share of how much it varies within the step.
const NEAR: f64 = 0.05;
/// And where the parabola through three of its values falls below this share of the middle one.
const DIP: f64 = 0.25;

/// What the guards were at the stages of a step.
#[derive(Clone, Debug)]
pub(crate) struct Glances<S> {
    room: Vec<S>,
    seen: [Vec<f64>; SHARES.len()],
    /// Whether the system shows its guards.
    shown: bool,
}

impl<S: Real> Glances<S> {
    pub fn new(guards: usize) -> Self {
        Self {
            room: vec![S::zero(); guards],
            seen: std::array::from_fn(|_| vec![0.0; guards]),
            shown: false,
        }
    }

    fn see(&mut self, index: usize, system: &mut impl System<S>) {
        self.shown = system.guards_here(&mut self.room);
        for (seen, guard) in self.seen[index].iter_mut().zip(&self.room) {
            *seen = guard.value();
        }
    }

    /// Evaluates the derivative at the step's beginning and looks at the guards there.
    pub fn begin(&mut self, system: &mut impl System<S>, step: &mut Step<S>) {
        step.begin(system);
        self.see(0, system);
    }

    /// Looks at the guards after the derivative of a stage.
    pub fn stage(&mut self, stage: usize, system: &mut impl System<S>) {
        if let Some(i) = STAGES.iter().position(|s| *s == stage) {
            self.see(i + 1, system);
        }
    }

    /// The end becomes the beginning.
    pub fn shift(&mut self) {
        self.seen.swap(0, SHARES.len() - 1);
    }

    /// Whether no guard can have crossed zero within the step.
    pub fn quiet(&self) -> bool {
        let of = |guard: usize| std::array::from_fn(|i| self.seen[i][guard]);
        self.shown && (0..self.room.len()).all(|guard| clear_of_zero(&of(guard)))
    }
}

fn clear_of_zero(seen: &[f64; SHARES.len()]) -> bool {
    let least = seen.iter().copied().fold(f64::INFINITY, f64::min);
    let most = seen.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !(least > 0.0 && least >= NEAR * (most - least)) {
        return false;
    }
    (1..SHARES.len() - 1).all(|i| {
        let [left, right] = [SHARES[i] - SHARES[i - 1], SHARES[i + 1] - SHARES[i]];
        let [before, after] = [seen[i - 1] - seen[i], seen[i + 1] - seen[i]];
        // v + s x + c x² through the three.
        let curvature = (before / left + after / right) / (left + right);
        let slope = after / right - curvature * right;
        let lowest = -0.5 * slope / curvature;
        let inside = curvature > 0.0 && lowest > -left && lowest < right;
        !inside || seen[i] + 0.5 * slope * lowest > DIP * seen[i]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_guard_that_comes_near_zero_is_told() {
        let clear = |guard: &dyn Fn(f64) -> f64| clear_of_zero(&SHARES.map(guard));
        assert!(clear(&|_| 1.0));
        assert!(clear(&|x| 2.0 - x));
        assert!(clear(&|x| 1.0 + (x - 0.4).powi(2)));
        assert!(!clear(&|x| 1.0 - 1.01 * x));
        assert!(!clear(&|x| 1.0 - 0.99 * x));
        // Below zero between the first and the second look, and between the last ones.
        assert!(!clear(&|x| 40.0 * (x - 0.1) * (x - 0.15)));
        assert!(!clear(&|x| 40.0 * (x - 0.92) * (x - 0.94)));
    }
}
