//! What a sensor says of itself, for machine files, schemas, bundles and tables.

use super::place::Place;
use crate::structure::Structure;
use mechanism::Machine;
use mechanism::declaration::{Clash, Quantity};

/// The declaration of a sensor.
#[derive(Clone, Copy, Debug)]
pub struct Declaration {
    /// What it measures.
    pub about: &'static str,
    /// What it is a value of.
    pub quantity: Quantity,
    /// Unit of the recorded numbers, written out.
    pub unit: &'static str,
    /// True where contacts move it at once, so that it is sampled as finely as they ring.
    pub feels_contacts: bool,
    /// Its channels: one, or one for each axis or chamber.
    pub channels: &'static [Channel],
    /// Whether a machine can have it at a place.
    pub check: fn(&Machine, &Place) -> Result<(), Clash>,
    /// What carries it, where that swings: it then records the response to what it reads of the motion.
    pub structure: fn(&Machine, &Place) -> Option<Structure>,
}

/// A channel of a recording.
#[derive(Clone, Copy, Debug)]
pub struct Channel {
    /// Its column, with the unit at its end, without the throw.
    pub column: &'static str,
    /// What people call it, in lower case, without the throw.
    pub words: &'static [&'static str],
}

impl Channel {
    /// The column of a throw of this name; the name is empty in a machine of one throw.
    pub fn column(&self, throw: &str) -> String {
        match throw {
            "" => self.column.to_owned(),
            throw => format!("{throw}.{}", self.column),
        }
    }
}

/// The check of a sensor that every machine can have.
pub(super) fn always(_: &Machine, _: &Place) -> Result<(), Clash> {
    Ok(())
}

/// What carries a sensor that sits on what it measures.
pub(super) fn rigid(_: &Machine, _: &Place) -> Option<Structure> {
    None
}

/// The check of a sensor on the frame.
pub(super) fn framed(machine: &Machine, _: &Place) -> Result<(), Clash> {
    match machine.frame {
        Some(_) => Ok(()),
        None => Err(Clash {
            key: "measure",
            expected: "a section frame in the machine".to_owned(),
        }),
    }
}
