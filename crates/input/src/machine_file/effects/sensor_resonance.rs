//! A sensor that resonates on its mount.
//!
//! A damped mass on a spring with the gain 1 at rest (Harris 2002, chapter 12): the measuring
//! chain's own `mounting`. Signature: one and the same ring after every blow, whatever its cause and
//! the speed.

use super::act::{Act, Place};
use simulate::{Resonance, Sensor};
use mechanism::declaration;

declaration! {
    /// Resonance of a sensor on its mount; it takes the place of the sensor's own.
    SensorResonance at [Throw, Measure], Sensor:
    "The sensor rings after every blow or sudden change of what it measures, always at the same pitch."
    law "mass on a spring with gain 1 at rest" after "Harris 2002" {
        /// Natural frequency; 2 kHz where it is left out. The effect is gone far above the band of
        /// the recording.
        frequency: Frequency(AboveZero), 100.0 to 20000.0, start 2000.0;
        /// Damping, of the critical one; 5 % where it is left out.
        damping_ratio: Ratio(FromZero), 0.005 to 0.7, start 0.05;
    }
}

impl Act for Values {
    fn sense(&self, sensor: &mut Sensor, place: &Place, throws: &[&str]) {
        if place.means(&sensor.measured, throws) {
            sensor.chain.mounting = Some(Resonance {
                frequency: self.frequency,
                damping_ratio: self.damping_ratio,
            });
        }
    }
}
