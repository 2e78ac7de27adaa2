//! An accelerometer on the crosshead, along the cylinder.

use super::declaration::{Channel, Declaration, always, rigid};
use mechanism::Evaluation;
use mechanism::declaration::Quantity;
use scalar::Scalar;

pub(super) const DECLARATION: Declaration = Declaration {
    about: "Acceleration of the crosshead along the cylinder, positive toward the head.",
    quantity: Quantity::Acceleration,
    unit: "m/s^2",
    feels_contacts: true,
    channels: &[Channel {
        column: "crosshead_acceleration_m_s2",
        words: &[
            "crosshead acceleration",
            "acceleration",
            "acc",
            "accelerometer",
            "crosshead vibration",
        ],
    }],
    check: always,
    structure: rigid,
};

/// The crosshead's own acceleration, and that of what the throw stands on.
#[inline(always)]
pub(super) fn read<S: Scalar>(at: &Evaluation<S>, throw: usize) -> S {
    let throw = &at.throws[throw];
    throw.accelerations.crosshead + throw.carried.x
}
