//! Gas that leaks past the piston rings.

use super::section::{Act, effect};
use crate::quantity::{Area, NonNegative, Positive, Velocity};
use mechanism::effects::{self, Law};

effect! {
    /// Leakage past the piston rings, as through throttles in series: flow = area × root of the
    /// difference of the squares of the pressures / gas_speed.
    RingLeakage at [throw, end], Gas:
    "The piston rings leak: gas escapes to the other side of the piston, so that the pressure rises too slowly and falls too fast." {
        /// Effective area: that of the gap over the root of the number of rings.
        area: NonNegative<Area>, 1e-8 to 3e-4, start 5e-6, absent 0.0;
        /// Root of gas constant times temperature in the suction line; 290 m/s, as for air, where it
        /// is left out.
        gas_speed: Positive<Velocity>, 150.0 to 500.0, start 290.0;
    }
}

impl Act for RingLeakage {
    fn law(&self) -> Option<Law> {
        Some(Law::RingLeakage(effects::RingLeakage {
            area: self.area(),
            gas_speed: self.gas_speed(),
        }))
    }
}
