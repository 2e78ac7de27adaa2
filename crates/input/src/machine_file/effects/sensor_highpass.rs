//! A channel that does not pass what is slow: a capacitor in a recorder's input, a charge amplifier, an accelerometer with
//! a built-in amplifier.
//!
//! A high-pass of the first order (Serridge and Licht 1987, chapter 3: the lower limiting frequency of a charge amplifier).
//! Signature: the first orders are too small and come too early, the more so the slower the crank; what is fast stays as it is.

use super::act::{Act, Place};
use mechanism::declaration;
use simulate::Sensor;

declaration! {
    /// Lower limiting frequency of what sensors read; it takes the place of the sensor's own.
    SensorHighpass at [Throw, Measure], Sensor:
    "The channel does not pass what is slow: the first orders of the crank are too small and come too early."
    law "high-pass of the first order" after "Serridge and Licht 1987" {
        /// Frequency at which it damps by 3 dB.
        cutoff: Frequency(FromZero), 0.02 to 50.0, start 2.0, absent 0.0;
    }
}

impl Act for Values {
    fn sense(&self, sensor: &mut Sensor, place: &Place, throws: &[&str]) {
        if place.means(&sensor.measured, throws) {
            sensor.chain.high_pass = Some(self.cutoff).filter(|cutoff| *cutoff > 0.0);
        }
    }
}
