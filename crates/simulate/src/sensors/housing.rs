//! What sensors on the housing of a crosshead guide share.

use super::place::{Axis, Place};
use crate::structure::{Resonance, Shows, Structure};
use mechanism::declaration::Clash;
use mechanism::{Evaluation, Machine};
use scalar::Scalar;
use std::f64::consts::TAU;

/// The check of a sensor on the housing.
pub(super) fn housed(machine: &Machine, place: &Place) -> Result<(), Clash> {
    match machine.throws[place.throw].housing {
        Some(_) => Ok(()),
        None => Err(Clash {
            key: "measure",
            expected: "a section housing in the machine".to_owned(),
        }),
    }
}

/// The housing, of which this is recorded.
pub(super) fn structure(machine: &Machine, place: &Place, shows: Shows) -> Option<Structure> {
    let housing = machine.throws[place.throw].housing.as_ref()?;
    let swing = match place.axis {
        Axis::X => &housing.x,
        Axis::Y => &housing.y,
    };
    Some(Structure {
        resonance: Resonance {
            frequency: swing.frequency / TAU,
            damping_ratio: swing.damping_ratio,
        },
        shows,
    })
}

/// What drives the housing, m/s².
#[inline(always)]
pub(super) fn drive<S: Scalar>(at: &Evaluation<S>, throw: usize, axis: Axis) -> S {
    let drive = at.throws[throw].housing;
    match axis {
        Axis::X => drive.x,
        Axis::Y => drive.y,
    }
}
