//! An encoder whose zero is not at top dead centre.
//!
//! The recorded angle is the crank's plus a constant; in the orders of a signal over it, order k is
//! turned by k times the offset.

use super::act::{Act, Place};
use simulate::{Measured, Sensor};
use mechanism::declaration;

declaration! {
    /// A constant added to the recorded crank angle.
    CrankAngleOffset at [], Sensor, CrankAngleZero:
    "The zero of the crank angle is not at top dead centre."
    law "recorded angle + constant" after "" {
        /// By how much the recorded angle is ahead of the crank.
        offset: Angle(Any), -0.35 to 0.35, start 0.02, absent 0.0;
    }
}

impl Act for Values {
    fn sense(&self, sensor: &mut Sensor, _: &Place, _: &[&str]) {
        if sensor.measured == Measured::CrankAngle {
            sensor.chain.angle_offset += self.offset;
        }
    }
}
