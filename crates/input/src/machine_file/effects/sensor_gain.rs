//! A sensor whose sensitivity is not the one that its recordings were scaled with.

use super::section::{Act, Section, effect};
use crate::quantity::{Quantity, Ratio};
use simulate::Sensor;

effect! {
    /// Wrong sensitivity of a sensor: everything it reads × (1 + error).
    SensorGain at [throw, measure], Sensor:
    "The sensor reads too much or too little, everywhere by the same share." {
        /// By how much it reads too much.
        error: Quantity<Ratio>, -0.5 to 0.5, start 0.05, absent 0.0;
    }
}

impl Act for SensorGain {
    fn sense(&self, sensor: &mut Sensor, throws: &[&str]) {
        if self.place().means(&sensor.measured, throws) {
            sensor.chain.gain *= 1.0 + self.error();
        }
    }
}
