//! Whether an effect goes together with a machine.

use super::Law;
use super::place::{End, Joint, Place};
use crate::declaration::Clash;
use crate::machine::{Machine, Throw};

impl Law {
    /// Whether a machine, as it is without effects, can have it at `place`.
    ///
    /// # Errors
    /// The first value that does not go together with the machine.
    pub fn check(&self, machine: &Machine, place: &Place) -> Result<(), Clash> {
        match self {
            Law::BearingOvality(law) => {
                let mut clearances = clearances(machine, place).into_iter();
                clearances.try_for_each(|clearance| law.check(clearance))
            }
            _ => Ok(()),
        }
    }
}

impl Place {
    /// Whether there is play for an effect on a joint to act on: it does nothing where the joint is ideal. Of an effect
    /// that names no joint, true.
    pub fn has_play(&self, machine: &Machine) -> bool {
        self.joint.is_none() || !clearances(machine, self).is_empty()
    }

    /// Whether one of its throws has the chamber that it names.
    pub fn has_chamber(&self, throws: &[Throw]) -> bool {
        let mut throws = throws.iter().enumerate();
        self.end != Some(End::Crank)
            || throws.any(|(i, throw)| {
                self.throw.is_none_or(|own| own == i) && throw.cylinder.crank_end.is_some()
            })
    }
}

/// The clearances at a place, m; without a joint that of the main bearing.
fn clearances(machine: &Machine, place: &Place) -> Vec<f64> {
    let throws = machine.throws.iter().enumerate();
    let throws = throws.filter(|(i, _)| place.throw.is_none_or(|throw| throw == *i));
    let joints: Vec<_> = match place.joint {
        Some(Joint::BigEnd) => throws.map(|(_, t)| &t.big_end).collect(),
        Some(Joint::SmallEnd) => throws.map(|(_, t)| &t.small_end).collect(),
        Some(Joint::Main) | None => vec![&machine.main],
    };
    let clear = joints.into_iter().filter_map(|joint| joint.clear());
    clear.map(|clear| clear.clearance).collect()
}
