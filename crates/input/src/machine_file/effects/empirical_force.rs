//! A force on the crosshead whose law was found in recordings.

use super::section::{Act, effect};
use crate::quantity::{Force, Positive, Quantity, Velocity};
use mechanism::effects::{self, Law};

effect! {
    /// A force on the crosshead along the cylinder, positive toward the head: a sum of the terms
    /// that are stated, each with its coefficient. Other terms there are none.
    EmpiricalForce at [throw], RunningGear, Separately:
    "A force acts on the crosshead that nothing in the catalogue gives: its law was found in the recordings." {
        /// Coefficient of 1.
        constant: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of cos α, α the crank angle since top dead centre.
        cos_1: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of sin α.
        sin_1: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of cos 2α.
        cos_2: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of sin 2α.
        sin_2: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of cos 3α.
        cos_3: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of sin 3α.
        sin_3: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of cos 4α.
        cos_4: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of sin 4α.
        sin_4: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of X, the displacement from mid-stroke over the length of the crank.
        displacement: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of X³.
        displacement_cubed: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of V, the crosshead's velocity over 1 m/s.
        velocity: Quantity<Force>, -2e4 to 2e4, start 20.0, absent 0.0;
        /// Coefficient of V |V|.
        velocity_squared: Quantity<Force>, -3e3 to 3e3, start 3.0, absent 0.0;
        /// Coefficient of V³.
        velocity_cubed: Quantity<Force>, -500.0 to 500.0, start 0.5, absent 0.0;
        /// Coefficient of the sign s of the velocity.
        velocity_sign: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of P s, P the head-end pressure over 1 bar.
        pressure_sign: Quantity<Force>, -2e4 to 2e4, start 20.0, absent 0.0;
        /// Coefficient of |G tan φ| s, G the gas force over that of 1 bar on the piston, φ the rod's angle.
        side_force_sign: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of an ideal crosshead's acceleration over that of gravity.
        acceleration: Quantity<Force>, -3e3 to 3e3, start 3.0, absent 0.0;
        /// Coefficient of G.
        gas_force: Quantity<Force>, -2e4 to 2e4, start 20.0, absent 0.0;
        /// Coefficient of the big end's offset along the cylinder over its clearance.
        big_end_offset: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of the small end's offset along the cylinder over its clearance.
        small_end_offset: Quantity<Force>, -1e5 to 1e5, start 100.0, absent 0.0;
        /// Speed over which the sign s changes; 0.05 m/s where it is left out.
        slip_speed: Positive<Velocity>, 0.001 to 0.5, start 0.05;
    }
}

impl Act for EmpiricalForce {
    fn law(&self) -> Option<Law> {
        Some(Law::EmpiricalForce(effects::EmpiricalForce {
            constant: self.constant(),
            cosines: [self.cos_1(), self.cos_2(), self.cos_3(), self.cos_4()],
            sines: [self.sin_1(), self.sin_2(), self.sin_3(), self.sin_4()],
            displacement: [self.displacement(), self.displacement_cubed()],
            velocity: [
                self.velocity(),
                self.velocity_squared(),
                self.velocity_cubed(),
            ],
            friction: [
                self.velocity_sign(),
                self.pressure_sign(),
                self.side_force_sign(),
            ],
            slip_speed: self.slip_speed(),
            acceleration: self.acceleration(),
            gas_force: self.gas_force(),
            offsets: [self.big_end_offset(), self.small_end_offset()],
        }))
    }
}
