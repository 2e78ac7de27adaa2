//! A rotating mass out of centre.

use super::section::{Act, Body, effect};
use crate::quantity::{Angle, Length, NonNegative, Quantity};
use mechanism::effects::{self, Law, Shaken};

effect! {
    /// An unbalance that turns with the crank and shakes the frame on soft mounts with the
    /// acceleration eccentricity × (speed of the crank)², which the sensor on the crosshead feels;
    /// or the crosshead alone, with that times its mass.
    RotatingUnbalance at [body], Frame:
    "Something that turns with the crank is out of balance and shakes the machine once a revolution, with the square of the speed." {
        /// Unbalance over the mass that it shakes.
        eccentricity: NonNegative<Length>, 1e-6 to 0.02, start 5e-4, absent 0.0;
        /// Angle by which it leads the crank; 0 deg where it is left out.
        phase: Quantity<Angle>, turn, start 0.0;
    }
}

impl Act for RotatingUnbalance {
    fn law(&self) -> Option<Law> {
        Some(Law::RotatingUnbalance(effects::RotatingUnbalance {
            eccentricity: self.eccentricity(),
            phase: self.phase(),
            body: match self.body {
                None | Some(Body::Frame) => Shaken::Frame,
                Some(Body::Crosshead) => Shaken::Crosshead,
            },
        }))
    }
}
