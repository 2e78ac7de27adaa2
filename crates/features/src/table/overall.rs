//! The part of the table that standards of machine vibration ask for: overall values in one band.

use super::line::{Line, Unit, Value};
use crate::spectral::OVERALL_HZ;

/// The values and the range of speeds are those of ISO 20816-8, which has limits for each part of the
/// system. The band is its low end and the upper end of its values.
const ISO: &str = "ISO 20816-8:2018 (overall values of reciprocating compressors at 120 to 1800 rpm), its \
    limits are for the frame, the cylinder and the pipes; crate signal, module overall_vibration";

pub(super) fn lines() -> impl Iterator<Item = Line> {
    let [low, high] = OVERALL_HZ;
    let line = |name: &str, unit, what: &str, formula, value| Line {
        name: format!("{name}_rms"),
        unit,
        description: format!(
            "RMS of the {what} from {low} to {high} Hz (or 0.4 of the sample rate, if that is less), over \
             the whole revolutions"
        ),
        formula,
        source: ISO,
        value: Value::Overall(value),
    };
    [
        line(
            "acceleration",
            Unit::Of("m/s^2"),
            "acceleration",
            "√Σ|A_k|²/2, A_k the amplitude at f_k",
            |overall| overall.acceleration,
        ),
        line(
            "velocity",
            Unit::Of("m/s"),
            "velocity",
            "√Σ|A_k/(2πf_k)|²/2",
            |overall| overall.velocity,
        ),
        line(
            "displacement",
            Unit::Of("m"),
            "displacement",
            "√Σ|A_k/(2πf_k)²|²/2",
            |overall| overall.displacement,
        ),
    ]
    .into_iter()
}
