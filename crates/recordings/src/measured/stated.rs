//! What a file states as a number beside its samples: the sample rate and the speed.

use crate::{Column, Kind, Value};

/// What a sample rate is called, in small letters and without its unit.
const RATES: [&str; 6] = [
    "fs",
    "sample_rate",
    "samplerate",
    "sampling_rate",
    "sample_frequency",
    "sampling_frequency",
];

/// Whether a number of this name is a sample rate, Hz.
pub(crate) fn is_sample_rate(name: &str) -> bool {
    let name = name.to_lowercase();
    RATES.contains(&name.strip_suffix("_hz").unwrap_or(&name))
}

/// Whether a number of this name is a speed, rpm.
pub(crate) fn is_speed(name: &str) -> bool {
    name.to_lowercase().ends_with("rpm")
}

/// The label of a speed in rpm; none for what is no speed.
pub(crate) fn speed_label(speed: f64) -> Option<(Column, Value)> {
    let column = Column::new("speed_rpm", Kind::Real, "speed of the crank").unit("rpm");
    (speed.is_finite() && speed > 0.0).then(|| (column.optional(), Value::from(speed)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_and_speeds_are_known_by_their_names() {
        for name in ["fs", "Fs", "sample_rate_hz", "Sampling_Frequency"] {
            assert!(is_sample_rate(name), "{name}");
        }
        assert!(!is_sample_rate("fs_acc"));
        assert!(is_speed("speed_RPM") && !is_speed("rpm_acc"));
        assert!(speed_label(0.0).is_none() && speed_label(f64::NAN).is_none());
    }
}
