//! A bearing that is not round.

use super::section::{Act, Part, effect};
use crate::error::Error;
use crate::quantity::{Angle, Length, NonNegative, Quantity};
use mechanism::Machine;
use mechanism::effects::{self, Joint, Law, Oval, Place};

effect! {
    /// An oval bearing or journal: clearance + amplitude cos 2(direction of contact − direction).
    /// Nothing in an ideal joint.
    BearingOvality at [throw, joint, part], Joint:
    "The bearing, or its journal, is worn oval: it has more play in one direction than in the other." {
        /// By how much the clearance is larger in the widest direction and smaller across it.
        amplitude: NonNegative<Length>, 1e-6 to 2e-4, start 3e-5, absent 0.0;
        /// Widest direction, 0 deg where it is left out: in the bearing from the rod's axis (at the
        /// main bearing from the cylinder's), in the journal from the crank's direction (at the small
        /// end from the cylinder's).
        direction: Quantity<Angle>, half_turn, start 0.0;
    }
}

impl Act for BearingOvality {
    fn law(&self) -> Option<Law> {
        Some(Law::BearingOvality(effects::BearingOvality {
            amplitude: self.amplitude(),
            direction: self.direction(),
            oval: match self.part {
                None | Some(Part::Bearing) => Oval::Bearing,
                Some(Part::Journal) => Oval::Journal,
            },
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
