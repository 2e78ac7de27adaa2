//! A pressure sensor in a chamber of a cylinder.

use super::declaration::{Channel, Declaration, rigid};
use super::place::{ChamberEnd, Place};
use mechanism::declaration::{Clash, Quantity};
use mechanism::{Evaluation, Machine};
use scalar::Scalar;

pub(super) const DECLARATION: Declaration = Declaration {
    about: "Gas pressure in a chamber.",
    quantity: Quantity::Pressure,
    unit: "Pa",
    feels_contacts: false,
    channels: &[
        Channel {
            column: "cylinder_pressure_pa",
            words: &[
                "cylinder pressure",
                "pressure",
                "head end pressure",
                "head end cylinder pressure",
                "cylinder pressure head end",
            ],
        },
        Channel {
            column: "cylinder_pressure_crank_end_pa",
            words: &[
                "crank end pressure",
                "crank end cylinder pressure",
                "cylinder pressure crank end",
            ],
        },
    ],
    check,
    structure: rigid,
};

fn check(machine: &Machine, place: &Place) -> Result<(), Clash> {
    let chamber = &machine.throws[place.throw].cylinder.crank_end;
    match place.end {
        ChamberEnd::Crank if chamber.is_none() => Err(Clash {
            key: "end",
            expected: "'head', or a section crank_end in the cylinder".to_owned(),
        }),
        ChamberEnd::Head | ChamberEnd::Crank => Ok(()),
    }
}

/// The absolute pressure.
#[inline(always)]
pub(super) fn read<S: Scalar>(at: &Evaluation<S>, throw: usize, end: ChamberEnd) -> S {
    let gas = &at.throws[throw].gas;
    match end {
        ChamberEnd::Head => gas.head_end.pressure,
        ChamberEnd::Crank => gas.crank_end.pressure,
    }
}
