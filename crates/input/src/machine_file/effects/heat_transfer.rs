//! Heat between gas and cylinder walls.

use super::section::{Act, effect};
use crate::quantity::{AboveZero, FromZero, Number};
use mechanism::effects::{self, Law};

effect! {
    /// Heat transfer between the gas and the walls of the cylinder by a Stanton number.
    HeatTransfer at [throw, end], Gas:
    "The cylinder walls heat the cool gas and cool the hot gas, so that its pressure leaves the curve of the exponent." {
        /// Stanton number: heat that the walls take up over the heat that flows past them.
        stanton: Number<FromZero>, 0.0002 to 0.1, start 0.01, absent 0.0;
        /// Temperature of the walls over that of the gas in the suction line; 1.2 where it is left
        /// out.
        wall_temperature: Number<AboveZero>, 0.9 to 1.6, start 1.2;
    }
}

impl Act for HeatTransfer {
    fn law(&self) -> Option<Law> {
        Some(Law::HeatTransfer(effects::HeatTransfer {
            stanton: self.stanton(),
            wall_temperature: self.wall_temperature(),
        }))
    }
}
