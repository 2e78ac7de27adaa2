//! Pressure lost across open valves.

use super::section::{Act, effect};
use crate::quantity::{FromZero, Number};
use mechanism::effects::{self, Law};

effect! {
    /// Pressure drop over an open valve: line pressure × coefficient × (piston speed / crank-pin
    /// speed)².
    ValveLoss at [throw, end], Gas:
    "The valves throttle the gas: while one is open, the pressure in the cylinder stays away from that of the line." {
        /// Loss coefficient of the suction valve.
        suction: Number<FromZero>, 0.002 to 0.5, start 0.1, absent 0.0;
        /// Loss coefficient of the discharge valve.
        discharge: Number<FromZero>, 0.002 to 0.5, start 0.1, absent 0.0;
    }
}

impl Act for ValveLoss {
    fn law(&self) -> Option<Law> {
        Some(Law::ValveLoss(effects::ValveLoss {
            suction: self.suction(),
            discharge: self.discharge(),
        }))
    }
}
