//! Misalignment of crosshead, piston rod and cylinder.

use super::section::{Act, effect};
use crate::quantity::{Angle, Force, NonNegative, Quantity};
use mechanism::effects::{self, Law};

effect! {
    /// Forces on the crosshead along the cylinder, once and twice a revolution.
    Misalignment at [throw], RunningGear:
    "Crosshead, piston rod and cylinder are not in line: they bind once or twice a revolution, at every speed alike." {
        /// Amplitude of the force once a revolution.
        first: NonNegative<Force>, 1.0 to 5000.0, start 200.0, absent 0.0;
        /// Its phase at top dead centre; 0 deg where it is left out.
        first_phase: Quantity<Angle>, turn, start 0.0;
        /// Amplitude of the force twice a revolution.
        second: NonNegative<Force>, 1.0 to 5000.0, start 200.0, absent 0.0;
        /// Its phase at top dead centre; 0 deg where it is left out.
        second_phase: Quantity<Angle>, turn, start 0.0;
    }
}

impl Act for Misalignment {
    fn law(&self) -> Option<Law> {
        Some(Law::Misalignment(effects::Misalignment {
            first: self.first(),
            first_phase: self.first_phase(),
            second: self.second(),
            second_phase: self.second_phase(),
        }))
    }
}
