//! Clearance that changes as the bearing warms up.
//!
//! Journal and bearing of different temperature or material change the clearance in proportion to the
//! rise of temperature, c = c0 + (α_B R_B − α_J R_J) ΔT. Friction heats the bearing with a power of the
//! speed: 1 at a constant load (Coulomb), 2 in oil (Petroff 1883). With the change stated at a speed,
//!
//! ```text
//! c = c0 + change (speed / at_speed)^exponent
//! ```
//!
//! constant within a run. Signature: extra clearance that grows, or falls, from run to run with the
//! speed.

use super::act::{Act, Draft, Place};
use crate::error::Error;
use scalar::Scalar;
use mechanism::declaration;

declaration! {
    /// Change of a joint's clearance with the speed, by the heat of its friction: change × (speed /
    /// at_speed)^exponent. Nothing in an ideal joint.
    ThermalClearance at [Throw, Joint], Joint:
    "The bearing grows warm, and its play changes with the speed at which the machine runs."
    law "c + Δc (speed/speed₀)ⁿ" after "Petroff 1883 for n = 2" {
        /// Change of the radial clearance at at_speed.
        change: Clearance(Any), -2e-4 to 2e-4, start 3e-5, absent 0.0;
        /// Speed at which it changes by that much; 500 rpm where it is left out.
        at_speed: Speed(AboveZero), 10.0 to 200.0, start 52.359_877_559_829_88;
        /// Power of the speed: 1 for dry friction (where it is left out), 2 for oil.
        exponent: Number(FromZero), 0.5 to 3.0, start 1.0;
    }
}

impl Act for Values {
    fn prepare(&self, file: &mut dyn Draft, place: &Place) -> Result<(), Error> {
        let speed = file.speed() / self.at_speed;
        let change = self.change * Scalar::powf(speed, self.exponent);
        for bearing in file.bearings(place)?.into_iter().flatten() {
            if bearing.gap() > 0.0 {
                if bearing.gap() + change <= 0.0 {
                    let expected = format_args!("a change that leaves some of {} m", bearing.gap());
                    return Err(Error::clash("change", expected));
                }
                bearing.widen(change);
            }
        }
        Ok(())
    }
}
