//! A frame that gives, and carries the sensors with it.
//!
//! The frame is the mass on springs of [`mechanism::frame`] (Harris 2002, Shock and Vibration
//! Handbook, chapter 2), driven by all forces of the running gear. A sensor on a crosshead reads the
//! crosshead's acceleration in the frame and the frame's own. Back on the machine the frame does not
//! act, which is right to the first order in the ratio of the masses. Signature: orders grow where
//! they meet one frequency, which is the same at every speed.

use super::act::Act;
use crate::error::Error;
use mechanism::Machine;
use mechanism::effects;
use mechanism::frame::Frame;
use std::f64::consts::TAU;
use mechanism::declaration;

declaration! {
    /// A frame that swings on its mounts, and with it the sensors on the crossheads. It takes the
    /// place of a section `frame`.
    FrameCompliance at [], Frame:
    "The frame gives on its mounts: the sensor on the crosshead also feels the frame swing, most near its own frequency."
    law "frame on a spring, which carries the crossheads' sensors" after "Harris 2002" {
        /// Mass of all crossheads over that of the frame.
        mass_ratio: Ratio(FromZero), 0.0005 to 0.5, start 0.04, absent 0.0;
        /// Natural frequency without damping; 40 Hz where it is left out.
        frequency: Frequency(AboveZero), 5.0 to 400.0, start 40.0;
        /// Damping, of the critical one; 5 % where it is left out.
        damping_ratio: Ratio(FromZero), 0.002 to 0.5, start 0.05;
        /// By what share its springs are stiffer where it has moved by 0.1 mm; 0 where it is left out.
        @shape hardening: Number(FromZero), 0.0 to 2.0, start 0.0;
    }
}

impl Act for Values {
    fn act(&self, machine: &mut Machine, _: &effects::Place) -> Result<(), Error> {
        let crossheads: f64 = machine.throws.iter().map(|t| t.crosshead.mass).sum();
        let mass = crossheads / self.mass_ratio;
        let rate = TAU * self.frequency;
        let stiffness = mass * rate * rate;
        let damping = 2.0 * self.damping_ratio * mass * rate;
        machine.frame = Some(Frame {
            mass,
            stiffness_x: stiffness,
            stiffness_y: stiffness,
            damping_x: damping,
            damping_y: damping,
            hardening: self.hardening,
            carries: true,
        });
        Ok(())
    }
}
