//! The part of the table that an indicator shows: the p-V card of a chamber.

use super::line::{Line, Unit, Value};

const HEYWOOD: &str = "Heywood 2018, Internal Combustion Engine Fundamentals, 2nd edition, section 2.4, \
    with the sign of a compressor; crate simulate, module indicator_card";

pub(super) fn lines() -> [Line; 2] {
    [
        Line {
            name: "indicated_power".to_owned(),
            unit: Unit::Of("W"),
            description:
                "Power that the piston gives to the gas of the chamber, mean over the whole \
                          revolutions"
                    .to_owned(),
            formula: "−n ∮ p dV, n revolutions per second",
            source: HEYWOOD,
            value: Value::Indicated(|card| card.power),
        },
        Line {
            name: "indicated_mean_pressure".to_owned(),
            unit: Unit::OfChannel,
            description:
                "Work of a revolution on the gas of the chamber, over the volume that the piston \
                          sweeps"
                    .to_owned(),
            formula: "−∮ p dV / (A s), A area of the piston, s stroke",
            source: HEYWOOD,
            value: Value::Indicated(|card| card.mean_pressure),
        },
    ]
}
