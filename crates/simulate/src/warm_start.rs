//! Where a settled motion stands, from which a machine near it goes on.
//!
//! A machine with clearances may have several motions that repeat themselves. From rest it may settle on any of them, and
//! the least change of a parameter decides on which. One that goes on from a settled motion stays on that motion's branch
//! while its parameters change little (continuation by the natural parameter: Seydel 2010, chapter 4).

use mechanism::joints::guide::Guide;
use mechanism::joints::revolute::Revolute;
use mechanism::mode::Mode;
use mechanism::{Dynamics, Machine};

/// A settled motion at a whole revolution of the crank.
#[derive(Clone, Debug, PartialEq)]
pub struct WarmStart {
    pub(crate) machine: Machine,
    pub(crate) state: Vec<f64>,
    pub(crate) mode: Mode<f64>,
}

impl WarmStart {
    /// The state from which `machine` goes on, and the contacts and valves that it takes over; none where it is of another
    /// build, or turns the other way.
    pub(crate) fn taken_over(&self, machine: &Machine) -> Option<(Vec<f64>, &Mode<f64>)> {
        let [before, after] = [&self.machine, machine];
        let turning = |machine: &Machine| machine.drive.reference_speed().signum();
        let dynamics = Dynamics::new(after.clone(), false);
        let same = Dynamics::new(before.clone(), false).layout() == dynamics.layout();
        if !same || turning(before) != turning(after) {
            return None;
        }
        let mut state = self.state.clone();
        rescale(before, &dynamics, &mut state);
        Some((state, &self.mode))
    }
}

/// Offsets in `y` of a machine with other clearances: a journal in contact keeps its penetration, one in flight its place relative to
/// the clearance.
pub(crate) fn rescale(before: &Machine, dynamics: &Dynamics<f64>, y: &mut [f64]) {
    let (after, layout) = (dynamics.machine(), dynamics.layout());
    let mut journal = |at: Option<usize>, joints: [&_; 2]| {
        let [old, new] = joints.map(Revolute::clear);
        if let (Some(i), Some(old), Some(new)) = (at, old, new) {
            let distance = y[i].hypot(y[i + 1]);
            let depth = distance - old.clearance;
            let factor = if depth > 0.0 {
                (new.clearance + depth) / distance
            } else {
                new.clearance / old.clearance
            };
            y[i] *= factor;
            y[i + 1] *= factor;
        }
    };
    journal(layout.main, [&before.main, &after.main]);
    let throws = before.throws.iter().zip(&after.throws);
    for ((old, new), at) in throws.clone().zip(&layout.throws) {
        journal(at.big_end, [&old.big_end, &new.big_end]);
        journal(at.small_end, [&old.small_end, &new.small_end]);
    }
    for ((old, new), at) in throws.zip(&layout.throws) {
        if let (Some(i), Guide::Clear(old), Guide::Clear(new)) = (at.guide, &old.guide, &new.guide)
        {
            y[i] *= new.clearance / old.clearance;
            y[i + 1] *= new.clearance / old.clearance;
        }
    }
}
