//! An accelerometer on the elastically mounted frame.

use super::declaration::{Channel, Declaration, framed, rigid};
use super::place::Axis;
use mechanism::Evaluation;
use mechanism::declaration::Quantity;
use scalar::Scalar;

pub(super) const DECLARATION: Declaration = Declaration {
    about: "Acceleration of the frame along an axis.",
    quantity: Quantity::Acceleration,
    unit: "m/s^2",
    feels_contacts: true,
    channels: &[
        Channel {
            column: "frame_acceleration_x_m_s2",
            words: &["frame acceleration x", "x frame acceleration"],
        },
        Channel {
            column: "frame_acceleration_y_m_s2",
            words: &["frame acceleration y", "y frame acceleration"],
        },
    ],
    check: framed,
    structure: rigid,
};

/// The frame's acceleration on its springs, and as effects shake it.
#[inline(always)]
pub(super) fn read<S: Scalar>(at: &Evaluation<S>, axis: Axis) -> S {
    match axis {
        Axis::X => at.frame_acceleration().x,
        Axis::Y => at.frame_acceleration().y,
    }
}
