//! Several machines of one build, each in a lane: what an ensemble integrates.

use crate::dynamics::Dynamics;
use crate::evaluation::Evaluation;
use crate::lift;
use crate::mode::Mode;
use integrate::System;
use scalar::{Lanes, Scalar};

/// `W` machines side by side, each in its own mode. Switches are made in each machine by itself.
#[derive(Clone, Debug)]
pub struct SideBySide<L>(Dynamics<L>);

impl<L> SideBySide<L> {
    /// The machines of these lanes as they are.
    ///
    /// Panics where they differ in build.
    pub fn new<const W: usize>(lanes: [&Dynamics<f64>; W]) -> Self
    where
        L: Lanes<W>,
    {
        let machines = lift::lanes(lanes.map(Dynamics::machine));
        let ledger = lanes[0].layout().ledger.is_some();
        let mut all = Self(Dynamics::new(machines, ledger));
        for (lane, dynamics) in lanes.into_iter().enumerate() {
            all.set_mode(lane, dynamics.mode());
        }
        all
    }

    /// Puts a lane into a mode.
    pub fn set_mode<const W: usize>(&mut self, lane: usize, mode: &Mode)
    where
        L: Lanes<W>,
    {
        let put = |number: &mut L, of: f64| number.set(lane, of);
        self.0.mode_mut().each(mode, put);
    }
}

impl<L: Scalar> SideBySide<L> {
    /// As [`Dynamics::evaluate_sensed`].
    pub fn evaluate_sensed(&mut self, t: L, y: &[L]) -> &Evaluation<L> {
        self.0.evaluate_sensed(t, y)
    }
}

impl<L: Scalar> System<L> for SideBySide<L> {
    fn dimension(&self) -> usize {
        self.0.layout().dimension
    }

    #[inline(always)]
    fn derivative(&mut self, t: L, y: &[L], dy: &mut [L]) {
        self.0.rates(t, y, dy);
    }

    fn scales(&self) -> &[L] {
        self.0.tolerance_scales()
    }

    fn guard_count(&self) -> usize {
        self.0.watches().len()
    }

    fn guards_here(&mut self, guards: &mut [L]) -> bool {
        self.0.write_guards(guards);
        true
    }
}
