//! A crank whose speed fluctuates within the revolution.
//!
//! ```text
//! θ̇ = ω (1 + d1 cos(ω t + ψ1) + d2 cos(2 ω t + ψ2))
//! ```
//!
//! Torque and inertia make it so (J ω dθ̇/dθ = T − load; Den Hartog 1956 on torque variation); here it is given by its first two harmonics. The motion is
//! [`mechanism::drive::GivenSpeed`]'s. Signature: angles and times disagree; orders beside each strong
//! one.

use super::act::Act;
use crate::error::Error;
use mechanism::Machine;
use mechanism::effects;
use mechanism::drive::{Drive, Fluctuation};
use mechanism::declaration;

declaration! {
    /// A given speed that fluctuates with one and two cycles a revolution.
    SpeedFluctuation at [], RunningGear, CrankSpeed:
    "The crank does not turn evenly: within each revolution it runs faster and slower."
    law "θ̇ = ω (1 + Σ d_k cos(k ω t + ψ_k)), k = 1, 2; given speed only" after "Den Hartog 1956" {
        /// Amplitude of the fluctuation once a revolution, of the mean speed.
        first: Ratio(FromZero), 0.0002 to 0.2, start 0.02, absent 0.0;
        /// Its phase; 0 deg where it is left out: the crank is fastest at its angle 0.
        first_phase: Angle(Any), turn, start 0.0;
        /// Amplitude of the fluctuation twice a revolution, of the mean speed.
        second: Ratio(FromZero), 0.0002 to 0.2, start 0.02, absent 0.0;
        /// Its phase; 0 deg where it is left out.
        second_phase: Angle(Any), turn, start 0.0;
    }
}

/// A crank that stops or turns back is no crank.
const MOST: f64 = 0.5;

impl Act for Values {
    fn act(&self, machine: &mut Machine, _: &effects::Place) -> Result<(), Error> {
        let Drive::Given(given) = &mut machine.drive else {
            let expected = "a crank of given speed; a free one fluctuates by itself";
            return Err(Error::clash("", expected));
        };
        for (key, amplitude) in [("first", self.first), ("second", self.second)] {
            if amplitude > MOST {
                return Err(Error::clash(key, "a percentage up to 50 %"));
            }
        }
        let harmonic = |amplitude, phase| Fluctuation { amplitude, phase };
        given.fluctuation = vec![
            harmonic(self.first, self.first_phase),
            harmonic(self.second, self.second_phase),
        ];
        Ok(())
    }
}
