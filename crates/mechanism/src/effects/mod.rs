//! The catalogue: physics that a first model leaves out, one effect per file.
//!
//! An effect is a line in the machine file; where the catalogue's list is empty the model is the
//! one of MODEL.md. A new effect is a file here, a variant, and an arm where it acts.

mod ring_friction;
mod valve_loss;

pub use ring_friction::RingFriction;
pub use valve_loss::ValveLoss;

use crate::lift::alternatives;
use scalar::Scalar;

alternatives! {
    /// An effect, with its parameters. Each acts on every throw.
    pub enum Effect<S> {
        /// Pressure drop across open valves.
        ValveLoss(ValveLoss),
        /// Friction of piston rings and packing.
        RingFriction(RingFriction),
    }
}

impl<S: Scalar> Effect<S> {
    /// Pressures at which the suction and the discharge valve hold the cylinder while open, Pa,
    /// at piston speed `piston` relative to the crank pin's speed.
    #[inline]
    pub(crate) fn line_pressures(&self, [suction, discharge]: [S; 2], piston: S) -> [S; 2] {
        match self {
            Effect::ValveLoss(loss) => loss.line_pressures([suction, discharge], piston),
            Effect::RingFriction(_) => [suction, discharge],
        }
    }

    /// Force on the crosshead body along x, N, at its speed (m/s) and head-end pressure (Pa).
    #[inline]
    pub(crate) fn piston_force(&self, speed: S, pressure: S) -> S {
        match self {
            Effect::RingFriction(rings) => rings.force(speed, pressure),
            Effect::ValveLoss(_) => S::zero(),
        }
    }
}
