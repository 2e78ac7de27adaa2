//! An encoder on the crankshaft.

use super::declaration::{Channel, Declaration, always, rigid};
use mechanism::Evaluation;
use mechanism::declaration::Quantity;
use scalar::Scalar;

pub(super) const DECLARATION: Declaration = Declaration {
    about: "Crank angle from 0 to one turn.",
    quantity: Quantity::Angle,
    unit: "rad",
    feels_contacts: false,
    channels: &[Channel {
        column: "crank_angle_rad",
        words: &["crank angle", "angle", "encoder", "crankshaft angle"],
    }],
    check: always,
    structure: rigid,
};

/// The angle since the start; what is recorded is where it stands in its turn.
#[inline(always)]
pub(super) fn read<S: Scalar>(at: &Evaluation<S>) -> S {
    at.angle
}
