//! Mains hum on the cable of an accelerometer.
//!
//! A sine of the line's frequency, which is independent of the crank. Its phase counts from the start of
//! the machine. The mean over many revolutions averages it out, unless it meets an order (50 Hz is order
//! 6 at 500 rpm).

use super::act::{Act, Measure, Place};
use simulate::{Hum, Sensor};
use mechanism::declaration;

declaration! {
    /// A sine of constant frequency on accelerometers.
    MainsHum at [Throw, Measure], Sensor, Hum:
    "The cable picks up the mains: a hum of 50 or 60 Hz whatever the speed."
    law "+ a cos(2π f t + φ)" after "" {
        /// Amplitude, in the unit of the sensor.
        amplitude: Acceleration(FromZero), 0.01 to 200.0, start 5.0, absent 0.0;
        /// Frequency; 50 Hz where it is left out.
        frequency: Frequency(AboveZero), 45.0 to 400.0, start 50.0;
        /// Phase at the start of the machine; 0 deg where it is left out.
        phase: Angle(Any), turn, start 0.0;
    }
}

impl Act for Values {
    fn sense(&self, sensor: &mut Sensor, place: &Place, throws: &[&str]) {
        if place.measure != Some(Measure::CylinderPressure) && place.means(&sensor.measured, throws)
        {
            sensor.chain.hum = Some(Hum {
                amplitude: self.amplitude,
                frequency: self.frequency,
                phase: self.phase,
            });
        }
    }
}
