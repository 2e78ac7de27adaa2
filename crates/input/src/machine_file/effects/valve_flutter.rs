//! Valves whose plates swing when they have opened.

use super::section::{Act, effect};
use crate::quantity::{Frequency, FromZero, Positive, ProperPart, Quantity, Ratio};
use mechanism::effects::{self, Law};
use std::f64::consts::TAU;

effect! {
    /// Valves that open late, and a damped swing of the cylinder's pressure about the line's after it.
    ValveFlutter at [throw, end], Gas:
    "The valves open late and flutter: the pressure overshoots and then ripples, always at the same pitch, until the plate has come to rest." {
        /// Natural frequency of the plates; 100 Hz where it is left out.
        frequency: Positive<Frequency>, 20.0 to 2000.0, start 100.0;
        /// Damping, of the critical one; 5 % where it is left out.
        damping_ratio: Quantity<Ratio, ProperPart>, 0.005 to 0.7, start 0.05;
        /// Overshoot at the suction valve, of the line's pressure.
        suction: Quantity<Ratio, ProperPart>, 0.002 to 0.3, start 0.05, absent 0.0;
        /// Overshoot at the discharge valve, of the line's pressure.
        discharge: Quantity<Ratio, FromZero>, 0.002 to 0.3, start 0.05, absent 0.0;
    }
}

impl Act for ValveFlutter {
    fn law(&self) -> Option<Law> {
        Some(Law::ValveFlutter(effects::ValveFlutter {
            natural_frequency: TAU * self.frequency(),
            damping_ratio: self.damping_ratio(),
            suction: self.suction(),
            discharge: self.discharge(),
        }))
    }
}
