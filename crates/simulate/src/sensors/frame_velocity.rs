//! A velocity sensor on the elastically mounted frame.

use super::declaration::{Channel, Declaration, framed, rigid};
use super::place::Axis;
use mechanism::Evaluation;
use mechanism::declaration::Quantity;
use scalar::Scalar;

pub(super) const DECLARATION: Declaration = Declaration {
    about: "Velocity of the frame along an axis.",
    quantity: Quantity::Velocity,
    unit: "m/s",
    feels_contacts: true,
    channels: &[
        Channel {
            column: "frame_velocity_x_m_s",
            words: &[
                "frame velocity x",
                "x frame velocity",
                "casing velocity",
                "casing velocity x",
                "horizontal casing velocity",
            ],
        },
        Channel {
            column: "frame_velocity_y_m_s",
            words: &[
                "frame velocity y",
                "y frame velocity",
                "casing velocity y",
                "vertical casing velocity",
            ],
        },
    ],
    check: framed,
    structure: rigid,
};

/// The frame's velocity on its springs, and as effects shake it.
#[inline(always)]
pub(super) fn read<S: Scalar>(at: &Evaluation<S>, axis: Axis) -> S {
    let [_, rate] = at.frame_motion;
    match axis {
        Axis::X => rate.x,
        Axis::Y => rate.y,
    }
}
