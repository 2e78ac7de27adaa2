//! An accelerometer on the elastically mounted frame.

use super::declaration::{Channel, Declaration};
use super::place::{Axis, Place};
use mechanism::declaration::{Clash, Quantity};
use mechanism::{Evaluation, Machine};
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
    check,
};

fn check(machine: &Machine, _: &Place) -> Result<(), Clash> {
    match machine.frame {
        Some(_) => Ok(()),
        None => Err(Clash {
            key: "measure",
            expected: "a section frame in the machine".to_owned(),
        }),
    }
}

/// The frame's acceleration on its springs, and as effects shake it.
#[inline(always)]
pub(super) fn read<S: Scalar>(at: &Evaluation<S>, axis: Axis) -> S {
    match axis {
        Axis::X => at.frame_acceleration().x,
        Axis::Y => at.frame_acceleration().y,
    }
}
