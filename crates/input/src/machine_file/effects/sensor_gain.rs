//! A sensor whose sensitivity is not the one that its recordings were scaled with.

use super::act::{Act, Place};
use simulate::Sensor;
use mechanism::declaration;

declaration! {
    /// Wrong sensitivity of a sensor: everything it reads × (1 + error).
    SensorGain at [Throw, Measure], Sensor:
    "The sensor reads too much or too little, everywhere by the same share."
    law "reading × (1 + error)" after "" {
        /// By how much it reads too much.
        error: Ratio(Any), -0.5 to 0.5, start 0.05, absent 0.0;
    }
}

impl Act for Values {
    fn sense(&self, sensor: &mut Sensor, place: &Place, throws: &[&str]) {
        if place.means(&sensor.measured, throws) {
            sensor.chain.gain *= 1.0 + self.error;
        }
    }
}
