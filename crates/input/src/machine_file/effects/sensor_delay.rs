//! A channel that comes late: an anti-alias filter, a converter that samples one channel after another, a recorder that
//! puts two instruments together.
//!
//! Signature: everything in the channel stands later by the same time, by an angle that grows with the speed; beside a
//! channel that is on time.

use super::act::{Act, Place};
use mechanism::declaration;
use simulate::Sensor;

declaration! {
    /// Delay of what sensors read.
    SensorDelay at [Throw, Measure], Sensor:
    "The channel is recorded too late, by the same time at every speed."
    law "reading of an earlier time" after "" {
        /// By how much it is late.
        delay: Duration(FromZero), 1e-6 to 5e-3, start 2e-4, absent 0.0;
    }
}

impl Act for Values {
    fn sense(&self, sensor: &mut Sensor, place: &Place, throws: &[&str]) {
        if place.means(&sensor.measured, throws) {
            sensor.chain.delay += self.delay;
        }
    }
}
