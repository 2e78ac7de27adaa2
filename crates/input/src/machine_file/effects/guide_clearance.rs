//! A crosshead with play in its guide.
//!
//! The guide of [`mechanism::joints::guide`] (Flores, Leine and Glocker 2010) in place of an ideal
//! one, with IMPACT at its corners and Coulomb friction. Signature: lateral blows where the side force
//! changes its sign, near the dead centres.

use super::act::Act;
use crate::error::Error;
use mechanism::Machine;
use mechanism::effects;
use mechanism::joints::contact::{ContactLaw, Impact};
use mechanism::joints::friction::{Coulomb, FrictionLaw};
use mechanism::joints::guide::{self, Guide};
use mechanism::declaration;

declaration! {
    /// Clearance of the crosshead in its guide, where the machine has an ideal one.
    GuideClearance at [Throw], Joint:
    "The crosshead has play in its guide: it knocks from one slide to the other."
    law "crosshead between two faces, IMPACT at its corners" after "Flores, Leine and Glocker 2010" {
        /// Gap to each face when the crosshead is centred.
        clearance: Clearance(FromZero), 5e-6 to 5e-4, start 1e-4, absent 0.0;
        /// Half the length of the crosshead's shoes; 90 mm where it is left out.
        half_length: Length(AboveZero), 0.03 to 0.3, start 0.09;
        /// Half the height of the crosshead; 70 mm where it is left out.
        half_height: Length(AboveZero), 0.03 to 0.3, start 0.07;
        /// Stiffness of a corner; 20 GN/m^1.5 where it is left out.
        stiffness: StiffnessPerRoot(AboveZero), 2e9 to 2e11, start 2e10;
        /// Damping of a corner; 2e4 N s/m where it is left out.
        damping: Damping(FromZero), 1e3 to 1e6, start 2e4;
        /// Coefficient of friction; 0.05 where it is left out.
        friction: Number(FromZero), 0.001 to 0.3, start 0.05;
    }
}

/// Penetration at which a corner's damping is full, m, and slip speed, m/s: as in the shipped
/// machine, which the shape of a knock hardly depends on.
const DEPTH: f64 = 1e-5;
const SLIP_SPEED: f64 = 0.01;

impl Act for Values {
    fn act(&self, machine: &mut Machine, place: &effects::Place) -> Result<(), Error> {
        let (length, height) = (self.half_length, self.half_height);
        if self.clearance >= height {
            let expected = format_args!("a length below half_height, {height} m");
            return Err(Error::clash("clearance", expected));
        }
        let throws = machine.throws.iter_mut().enumerate();
        for (_, throw) in throws.filter(|(i, _)| place.throw.is_none_or(|throw| throw == *i)) {
            if throw.guide.clear().is_some() {
                return Err(Error::clash("clearance", "an ideal guide in joints.guide"));
            }
            if throw.crosshead.inertia == 0.0 {
                // A block of the crosshead's mass and size.
                let square = length * length + height * height;
                throw.crosshead.inertia = throw.crosshead.mass * square / 3.0;
            }
            throw.guide = Guide::Clear(guide::GuideClearance {
                clearance: self.clearance,
                half_length: length,
                half_height: height,
                contact: ContactLaw::Impact(Impact {
                    stiffness: self.stiffness,
                    exponent: 1.5,
                    damping: self.damping,
                    depth: DEPTH,
                }),
                friction: FrictionLaw::Coulomb(Coulomb {
                    coefficient: self.friction,
                    slip_speed: SLIP_SPEED,
                }),
            });
        }
        Ok(())
    }
}
