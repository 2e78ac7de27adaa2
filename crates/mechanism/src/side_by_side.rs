//! Several machines of one build, each in a lane: what an ensemble integrates.

use crate::dynamics::Dynamics;
use crate::lift;
use integrate::System;
use scalar::Lanes;

/// `W` machines side by side, each in its own mode. Switches are made in each machine by itself.
#[derive(Clone, Debug)]
pub struct SideBySide<const W: usize>(Dynamics<Lanes<W>>);

impl<const W: usize> SideBySide<W> {
    /// The machines of these lanes as they are.
    ///
    /// Panics where they differ in build.
    pub fn new(lanes: [&Dynamics<f64>; W]) -> Self {
        let machines = lift::lanes(lanes.map(Dynamics::machine));
        let ledger = lanes[0].layout().ledger.is_some();
        let mut all = Self(Dynamics::new(machines, ledger));
        all.set_modes(lanes);
        all
    }

    /// Puts each lane into the mode of its machine.
    pub fn set_modes(&mut self, lanes: [&Dynamics<f64>; W]) {
        *self.0.mode_mut() = lift::lanes(lanes.map(Dynamics::mode));
    }
}

impl<const W: usize> System<Lanes<W>> for SideBySide<W> {
    fn dimension(&self) -> usize {
        self.0.layout().dimension
    }

    fn derivative(&mut self, t: Lanes<W>, y: &[Lanes<W>], dy: &mut [Lanes<W>]) {
        self.0.evaluate_rates(t, y);
        self.0.write_derivative(y, dy);
    }

    fn scales(&self) -> &[Lanes<W>] {
        self.0.tolerance_scales()
    }

    fn guard_count(&self) -> usize {
        self.0.watches().len()
    }

    fn guards_here(&mut self, guards: &mut [Lanes<W>]) -> bool {
        self.0.write_guards(guards);
        true
    }
}
