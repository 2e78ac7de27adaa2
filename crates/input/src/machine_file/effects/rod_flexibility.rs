//! A connecting rod that gives along its axis.

use super::section::{Act, effect};
use crate::quantity::{Compliance, FromZero, NonNegative, Quantity, Ratio};
use mechanism::effects::{self, Law};

effect! {
    /// A connecting rod that is a spring along its axis.
    RodFlexibility at [throw], RunningGear:
    "The connecting rod springs along its length: after every change of load it rings at one and the same pitch." {
        /// How much longer a force makes it: length / (Young's modulus × area of its shank).
        compliance: NonNegative<Compliance>, 3e-10 to 1e-7, start 5e-9, absent 0.0;
        /// Damping, of the critical one of the free rod; 2 % where it is left out.
        damping_ratio: Quantity<Ratio, FromZero>, 0.002 to 0.2, start 0.02;
    }
}

impl Act for RodFlexibility {
    fn law(&self) -> Option<Law> {
        Some(Law::RodFlexibility(effects::RodFlexibility {
            compliance: self.compliance(),
            damping_ratio: self.damping_ratio(),
        }))
    }
}
