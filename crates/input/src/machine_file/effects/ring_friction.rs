//! Friction of piston rings and packing.

use super::section::{Act, effect};
use crate::quantity::{Force, ForcePerPressure, NonNegative, Positive, Velocity};
use mechanism::effects::{self, Law};

effect! {
    /// Friction of the rings: a constant part and one that grows with the gas pressure.
    RingFriction at [throw], RunningGear:
    "The piston rings and the packing rub: a force against the motion that changes sign at both dead centres." {
        /// Friction force without gas pressure.
        coulomb_force: NonNegative<Force>, 1.0 to 5000.0, start 100.0, absent 0.0;
        /// Friction force per head-end pressure.
        per_pressure: NonNegative<ForcePerPressure>, 1e-6 to 5e-3, start 2e-4, absent 0.0;
        /// Piston speed over which the change of sign is spread; 0.05 m/s where it is left out.
        slip_speed: Positive<Velocity>, 0.001 to 0.5, start 0.05;
    }
}

impl Act for RingFriction {
    fn law(&self) -> Option<Law> {
        Some(Law::RingFriction(effects::RingFriction {
            coulomb_force: self.coulomb_force(),
            per_pressure: self.per_pressure(),
            slip_speed: self.slip_speed(),
        }))
    }
}
