//! The guards at the stages of a step. Where none approaches zero there, there is no
//! need to look into the step.
//!
//! A stage is evaluated at a state near to the solution at its node, and the last two at the
//! solution at the step's end. That costs nothing more, where a look at the continuous extension
//! takes three derivatives for the extension and one more for each look.

use crate::dop853::Step;
use crate::system::System;
use scalar::{Lanes, Mask, Scalar};

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
pub(crate) struct Glances<S: Scalar> {
    room: Vec<S>,
    seen: [Vec<S::Plain>; SHARES.len()],
    /// Whether the system shows its guards.
    shown: bool,
}

impl<S: Scalar> Glances<S> {
    pub fn new(guards: usize) -> Self {
        Self {
            room: vec![S::constant(0.0); guards],
            seen: std::array::from_fn(|_| vec![S::Plain::constant(0.0); guards]),
            shown: false,
        }
    }

    fn see(&mut self, index: usize, system: &mut impl System<S>) {
        self.shown = system.guards_here(&mut self.room);
        for (seen, guard) in self.seen[index].iter_mut().zip(&self.room) {
            *seen = guard.plain();
        }
    }

    /// Evaluates the derivative at the step's beginning and looks at the guards there.
    pub fn begin(&mut self, system: &mut impl System<S>, step: &mut Step<S>) {
        step.begin(system);
        self.see(0, system);
    }

    /// Looks at the guards after the derivative of a stage.
    #[inline(always)]
    pub fn stage(&mut self, stage: usize, system: &mut impl System<S>) {
        if let Some(i) = STAGES.iter().position(|s| *s == stage) {
            self.see(i + 1, system);
        }
    }

    /// The end becomes the beginning.
    pub fn shift(&mut self) {
        self.seen.swap(0, SHARES.len() - 1);
    }

    /// The guards at the step's beginning and end; none where the system does not show them.
    pub fn ends(&self) -> Option<[&[S::Plain]; 2]> {
        let [first, .., last] = &self.seen;
        self.shown.then_some([first, last])
    }

    /// Where no guard can have crossed zero within the step; none where the system does not show
    /// them.
    pub fn quiet(&self) -> Option<S::Mask> {
        self.shown.then(|| {
            S::vectorised(
                #[inline(always)]
                || {
                    let mut quiet = S::Plain::constant(0.0).lt(S::Plain::constant(1.0));
                    let count = self.room.len();
                    let [a, b, c, d, e] = &self.seen;
                    let [a, b, c, d, e] = [
                        &a[..count],
                        &b[..count],
                        &c[..count],
                        &d[..count],
                        &e[..count],
                    ];
                    for guard in 0..count {
                        let seen = [a[guard], b[guard], c[guard], d[guard], e[guard]];
                        quiet = quiet.and(clear_of_zero(&seen));
                    }
                    quiet
                },
            )
        })
    }
}

impl<L: Scalar<Plain = L>> Glances<L> {
    /// In the lanes of the mask the end becomes the beginning.
    pub fn shift_where(&mut self, mask: L::Mask) {
        let [first, .., last] = &mut self.seen;
        L::vectorised(
            #[inline(always)]
            || {
                for (first, last) in first.iter_mut().zip(last) {
                    *first = L::select(mask, *last, *first);
                }
            },
        );
    }

    /// Makes the guards at the beginning or at the end of a lane's step those of `other`.
    pub fn give<const W: usize>(&self, lane: usize, other: &mut Glances<f64>)
    where
        L: Lanes<W>,
    {
        other.shown = self.shown;
        for at in [0, SHARES.len() - 1] {
            for (to, from) in other.seen[at].iter_mut().zip(&self.seen[at]) {
                *to = from.get(lane);
            }
        }
    }

    /// Takes the guards at the beginning of a lane's step from `other`.
    pub fn take_beginning<const W: usize>(&mut self, lane: usize, other: &Glances<f64>)
    where
        L: Lanes<W>,
    {
        for (to, from) in self.seen[0].iter_mut().zip(&other.seen[0]) {
            to.set(lane, *from);
        }
    }
}

/// Whether a guard of these values stays above zero between them. No division: they take long.
#[inline(always)]
fn clear_of_zero<T: Scalar>(seen: &[T; SHARES.len()]) -> T::Mask {
    let zero = T::constant(0.0);
    let [mut least, mut most] = [seen[0]; 2];
    for value in &seen[1..] {
        least = least.min(*value);
        most = most.max(*value);
    }
    let near = (most - least) * NEAR;
    let mut clear = zero.lt(least).and(least.lt(near).not());
    for i in 1..SHARES.len() - 1 {
        let [left, right] = [SHARES[i] - SHARES[i - 1], SHARES[i + 1] - SHARES[i]];
        let [before, after] = [seen[i - 1] - seen[i], seen[i + 1] - seen[i]];
        // v + s x + c x² through the three, lowest at −s/2c, where it is v − s²/4c.
        let curvature = (before * (1.0 / left) + after * (1.0 / right)) * (1.0 / (left + right));
        let slope = after * (1.0 / right) - curvature * right;
        let lowest = slope * -0.5;
        let within = (curvature * -left)
            .lt(lowest)
            .and(lowest.lt(curvature * right));
        let deep = slope * slope * 0.25;
        let high = deep.lt(seen[i] * (1.0 - DIP) * curvature);
        clear = clear.and(zero.lt(curvature).and(within).not().or(high));
    }
    clear
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_guard_that_approaches_zero_is_seen() {
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
