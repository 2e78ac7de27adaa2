//! The units in which people read values.

/// The unit in which people read a value of this SI unit, and the factor to it.
pub(super) fn usual(unit: &str) -> (f64, &str) {
    match unit {
        "rad" => (1_f64.to_degrees(), "deg"),
        "m" => (1e3, "mm"),
        "m^2" => (1e6, "mm^2"),
        "%" => (100.0, "%"),
        other => (1.0, other),
    }
}
