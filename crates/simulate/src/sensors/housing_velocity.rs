//! A velocity sensor on the housing of a crosshead guide.

use super::declaration::{Channel, Declaration};
use super::housing::{drive, housed, structure};
use super::place::Axis;
use crate::structure::Shows;
use mechanism::Evaluation;
use mechanism::declaration::Quantity;
use scalar::Scalar;

pub(super) const DECLARATION: Declaration = Declaration {
    about: "Velocity of the housing of the crosshead guide: x along the cylinder, toward the head; y across the guide.",
    quantity: Quantity::Velocity,
    unit: "m/s",
    feels_contacts: true,
    channels: &[
        Channel {
            column: "housing_velocity_x_m_s",
            words: &[
                "housing velocity x",
                "guide velocity x",
                "axial guide velocity",
                "crosshead guide velocity x",
            ],
        },
        Channel {
            column: "housing_velocity_y_m_s",
            words: &[
                "housing velocity",
                "housing velocity y",
                "guide velocity",
                "guide velocity y",
                "crosshead guide velocity",
                "guide housing velocity",
            ],
        },
    ],
    check: housed,
    structure: |machine, place| structure(machine, place, Shows::Velocity),
};

/// What drives the housing. What is recorded is its response.
#[inline(always)]
pub(super) fn read<S: Scalar>(at: &Evaluation<S>, throw: usize, axis: Axis) -> S {
    drive(at, throw, axis)
}
