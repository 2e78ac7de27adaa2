//! A sensor whose zero has drifted.
//!
//! Everything that it reads is higher by a constant, after gain and filters: the zero of a charge
//! amplifier, a gauge whose ambient pressure is not the one that was taken. Signature: the mean of the
//! signal alone is wrong; its harmonics are right at every speed and load.

use super::act::{Act, Measure, Place};
use mechanism::declaration;
use simulate::Sensor;

declaration! {
    /// A constant added to what sensors read, in their unit: one to all accelerometers, one to all
    /// gauges of cylinder pressure.
    SensorOffset at [Throw], Sensor:
    "The sensor's zero has drifted: it reads too much or too little, everywhere by the same amount."
    law "reading + constant" after "" {
        /// Constant added to accelerations.
        acceleration: Acceleration(Any), -50.0 to 50.0, start 2.0, absent 0.0;
        /// Constant added to pressures.
        pressure: Pressure(Any), -2e5 to 2e5, start 5e3, absent 0.0;
    }
}

impl Act for Values {
    fn sense(&self, sensor: &mut Sensor, place: &Place, throws: &[&str]) {
        for (measure, offset) in [
            (Measure::CrossheadAcceleration, self.acceleration),
            (Measure::FrameAcceleration, self.acceleration),
            (Measure::CylinderPressure, self.pressure),
        ] {
            let measure = Some(measure);
            let place = Place {
                measure,
                ..place.clone()
            };
            if place.means(&sensor.measured, throws) {
                sensor.chain.offset += offset;
            }
        }
    }
}
