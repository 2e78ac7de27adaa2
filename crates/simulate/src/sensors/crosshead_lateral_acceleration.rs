//! An accelerometer on the crosshead, across the guide.

use super::declaration::{Channel, Declaration, always, rigid};
use mechanism::Evaluation;
use mechanism::declaration::Quantity;
use scalar::Scalar;

pub(super) const DECLARATION: Declaration = Declaration {
    about: "Acceleration of the crosshead across the guide (not 0 only with clearance there).",
    quantity: Quantity::Acceleration,
    unit: "m/s^2",
    feels_contacts: true,
    channels: &[Channel {
        column: "crosshead_lateral_acceleration_m_s2",
        words: &["crosshead lateral acceleration", "lateral acceleration"],
    }],
    check: always,
    structure: rigid,
};

/// The shift's acceleration in the guide, and that of what the throw stands on.
#[inline(always)]
pub(super) fn read<S: Scalar>(at: &Evaluation<S>, throw: usize) -> S {
    let throw = &at.throws[throw];
    throw.accelerations.guide.x + throw.carried.y
}
