//! A bearing that is not round.

use super::section::{Act, effect};
use crate::error::Error;
use crate::quantity::{Angle, Length, NonNegative, Quantity};
use mechanism::Machine;
use mechanism::effects::{self, Joint, Law, Place};

effect! {
    /// An oval bearing: clearance + amplitude cos 2(direction from the rod's axis − direction).
    /// Nothing in an ideal joint.
    BearingOvality at [throw, joint]:
    "The bearing is worn oval: it has more play in one direction than in the other." {
        /// By how much the clearance is larger in the widest direction and smaller across it.
        amplitude: NonNegative<Length>, 1e-6 to 2e-4, start 3e-5, absent 0.0;
        /// Widest direction, from the rod's axis (from the cylinder's, at the main bearing); 0 deg
        /// where it is left out.
        direction: Quantity<Angle>, half_turn, start 0.0;
    }
}

impl Act for BearingOvality {
    fn law(&self) -> Option<Law> {
        Some(Law::BearingOvality(effects::BearingOvality {
            amplitude: self.amplitude(),
            direction: self.direction(),
        }))
    }

    fn act(&self, machine: &mut Machine, place: &Place) -> Result<(), Error> {
        let throws = machine.throws.iter().enumerate();
        let throws = throws.filter(|(i, _)| place.throw.is_none_or(|throw| throw == *i));
        let joints: Vec<_> = match place.joint {
            Some(Joint::BigEnd) => throws.map(|(_, t)| &t.big_end).collect(),
            Some(Joint::SmallEnd) => throws.map(|(_, t)| &t.small_end).collect(),
            Some(Joint::Main) | None => vec![&machine.main],
        };
        for clear in joints.into_iter().filter_map(|joint| joint.clear()) {
            if self.amplitude() >= clear.clearance {
                let expected = format_args!("a length below the clearance, {} m", clear.clearance);
                return Err(Error::clash("amplitude", expected));
            }
        }
        Ok(())
    }
}
