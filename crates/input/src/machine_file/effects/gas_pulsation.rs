//! Pulsation of the pressures in the lines.

use super::section::{Act, effect};
use crate::choice::Count;
use crate::quantity::{Angle, FromZero, Quantity, Ratio};
use mechanism::effects::{self, Law};

effect! {
    /// A harmonic of the line pressures: pressure × (1 + amplitude cos(order × crank angle + phase)).
    GasPulsation at [throw, end], Gas:
    "The pressure in the pipes pulsates: while a valve is open, the cylinder's pressure swings with the line." {
        /// Cycles a revolution; 2 where it is left out.
        order: Count<1, 24>, 1.0 to 8.0, start 2.0;
        /// Amplitude in the suction line, of its pressure.
        suction: Quantity<Ratio, FromZero>, 0.001 to 0.2, start 0.02, absent 0.0;
        /// Its phase; 0 deg where it is left out.
        suction_phase: Quantity<Angle>, turn, start 0.0;
        /// Amplitude in the discharge line, of its pressure.
        discharge: Quantity<Ratio, FromZero>, 0.001 to 0.2, start 0.02, absent 0.0;
        /// Its phase; 0 deg where it is left out.
        discharge_phase: Quantity<Angle>, turn, start 0.0;
    }
}

impl Act for GasPulsation {
    fn law(&self) -> Option<Law> {
        Some(Law::GasPulsation(effects::GasPulsation {
            order: self.order(),
            suction: self.suction(),
            suction_phase: self.suction_phase(),
            discharge: self.discharge(),
            discharge_phase: self.discharge_phase(),
        }))
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a count"
    )]
    fn order(&self) -> Option<u32> {
        Some(self.order() as u32)
    }
}
