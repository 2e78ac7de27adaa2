//! More clearance in a joint than the file says.
//!
//! The clearance is added before the contact is worked out, so that contact parameters that follow the
//! clearance (see `relation`) follow it here too. An ideal joint becomes clear, with the contact that
//! stands in its section. Signature: later and harder blows, by c^(1/3) and c^(2/3) (smooth reversals).

use super::act::{Act, Draft, Place};
use crate::error::Error;
use mechanism::declaration;

declaration! {
    /// Clearance on top of the joint's own. The joint needs a section, with journal_radius and
    /// contact; with `clearance: ideal` it becomes clear.
    ExtraClearance at [Throw, Joint], Joint:
    "The joint has more play than was believed."
    law "c + Δc; an ideal joint becomes clear" after "" {
        /// By how much the radial clearance is larger.
        clearance: Clearance(FromZero), 2e-6 to 5e-4, start 5e-5, absent 0.0;
    }
}

impl Act for Values {
    fn prepare(&self, file: &mut dyn Draft, place: &Place) -> Result<(), Error> {
        for bearing in file.bearings(place)? {
            let Some(bearing) = bearing else {
                let expected = "a joint with a section that has journal_radius and contact";
                return Err(Error::clash("joint", expected));
            };
            bearing.widen(self.clearance);
        }
        Ok(())
    }
}
