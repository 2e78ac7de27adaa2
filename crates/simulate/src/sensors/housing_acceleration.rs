//! An accelerometer on the housing of a crosshead guide.

use super::declaration::{Channel, Declaration};
use super::housing::{drive, housed, structure};
use super::place::Axis;
use crate::structure::Shows;
use mechanism::Evaluation;
use mechanism::declaration::Quantity;
use scalar::Scalar;

pub(super) const DECLARATION: Declaration = Declaration {
    about: "Acceleration of the housing of the crosshead guide: x along the cylinder, toward the head; y across the guide.",
    quantity: Quantity::Acceleration,
    unit: "m/s^2",
    feels_contacts: true,
    channels: &[
        Channel {
            column: "housing_acceleration_x_m_s2",
            words: &[
                "housing acceleration x",
                "guide acceleration x",
                "axial guide acceleration",
                "crosshead guide acceleration x",
            ],
        },
        Channel {
            column: "housing_acceleration_y_m_s2",
            words: &[
                "housing acceleration",
                "housing acceleration y",
                "guide acceleration",
                "guide acceleration y",
                "crosshead guide acceleration",
                "guide housing acceleration",
                "guide vibration",
            ],
        },
    ],
    check: housed,
    structure: |machine, place| structure(machine, place, Shows::Acceleration),
};

/// What drives the housing. What is recorded is its response.
#[inline(always)]
pub(super) fn read<S: Scalar>(at: &Evaluation<S>, throw: usize, axis: Axis) -> S {
    drive(at, throw, axis)
}
