//! An encoder on the crankshaft, read as a speed: how evenly the crank turns.

use super::declaration::{Channel, Declaration, always, rigid};
use mechanism::Evaluation;
use mechanism::declaration::Quantity;
use scalar::Scalar;

pub(super) const DECLARATION: Declaration = Declaration {
    about: "Speed of the crank at each instant.",
    quantity: Quantity::Speed,
    unit: "rad/s",
    feels_contacts: true,
    channels: &[Channel {
        column: "crank_speed_rad_s",
        words: &["crank speed", "crankshaft speed", "instantaneous speed"],
    }],
    check: always,
    structure: rigid,
};

/// The rate of the crank angle.
#[inline(always)]
pub(super) fn read<S: Scalar>(at: &Evaluation<S>) -> S {
    at.speed
}
