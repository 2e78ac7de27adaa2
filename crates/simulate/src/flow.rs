//! What tangents can be carried along: a system written over every real scalar.

use integrate::{Real, System};
use mechanism::drive::Drive;
use mechanism::state::Layout;
use mechanism::{Dynamics, Machine, lift};
use std::f64::consts::TAU;

/// A flow with a cycle: a forced oscillator, a machine.
pub trait Flow {
    /// The equations over a scalar. A copy is in the same mode.
    type System<S: Real>: System<S> + Clone;

    /// The equations in their first mode, and the state at t = 0.
    fn start<S: Real>(&self) -> (Self::System<S>, Vec<S>);

    /// What counts as one revolution.
    fn cycle(&self) -> Cycle;

    /// What the present derivative depends on beside time, state and switches, each measured by a
    /// scale of 1: numbers that a mode remembers.
    fn memory<S: Real>(_system: &mut Self::System<S>) -> Vec<&mut S> {
        Vec::new()
    }
}

/// The phase of a flow in its cycle: `rate` · t, plus a component of the state
/// where nothing dictates the angle. In that case the flow must depend on time through the angle
/// alone: it is autonomous, and the length of its period is its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// Rate of the angle, or about that, rad/s.
    pub rate: f64,
    /// Which component of the state the angle adds, where it turns freely.
    pub free: Option<usize>,
}

impl Cycle {
    /// Length of a revolution (of a free one, at the reference speed), s.
    pub fn length(&self) -> f64 {
        TAU / self.rate.abs()
    }

    /// Revolutions made at time `t` in state `y`.
    pub(crate) fn turns<S: Real>(&self, t: f64, y: &[S]) -> f64 {
        let deviation = self.free.map_or(0.0, |i| y[i].value());
        (self.rate * t + deviation) * self.rate.signum() / TAU
    }
}

impl Flow for Machine {
    type System<S: Real> = Dynamics<S>;

    fn start<S: Real>(&self) -> (Dynamics<S>, Vec<S>) {
        // The frame only listens, and its own decay is no part of the machine's motion.
        let machine = Machine {
            frame: None,
            ..self.clone()
        };
        let dynamics = Dynamics::new(lift::constants(&machine), false);
        let state = dynamics.initial_state();
        (dynamics, state)
    }

    fn cycle(&self) -> Cycle {
        let free = match self.drive {
            Drive::Given(_) => None,
            Drive::Free(_) => Layout::new(self, false).crank,
        };
        Cycle {
            rate: self.drive.reference_speed(),
            free,
        }
    }

    fn memory<S: Real>(dynamics: &mut Dynamics<S>) -> Vec<&mut S> {
        dynamics.memory_mut()
    }
}
