//! What a file states as a number beside its samples: the sample rate and the speed.

use crate::{Column, Kind, Value};

/// A rate and a time column, or two rates, contradict each other when they differ by more.
const RATE_TOLERANCE: f64 = 0.01;

/// What a sample rate is called, in small letters, with blanks and without its unit.
pub(crate) const RATES: [&str; 16] = [
    "fs",
    "sample rate",
    "samplerate",
    "sampling rate",
    "samplingrate",
    "sample frequency",
    "samplefrequency",
    "sampling frequency",
    "samplingfrequency",
    "sample freq",
    "sampling freq",
    "abtastrate",
    "abtastfrequenz",
    "samples/s",
    "samples/sec",
    "samples per second",
];

/// What the time between two samples is called in a heading, as [`RATES`].
pub(crate) const PERIODS: [&str; 12] = [
    "dt",
    "delta t",
    "delta x",
    "sample interval",
    "sampleinterval",
    "sampling interval",
    "samplinginterval",
    "sample period",
    "sampleperiod",
    "sampling period",
    "samplingperiod",
    "abtastintervall",
];

/// A sample rate that is stated beside the samples.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StatedRate {
    /// Samples per second.
    pub(crate) hz: f64,
    /// The place of the heading that states it: a column of time then counts more. None where a number in the file or the
    /// reader states it.
    pub(crate) heading: Option<String>,
}

impl StatedRate {
    /// One that a number in the file or the reader states, Hz.
    pub(crate) fn number(hz: f64) -> Self {
        Self { hz, heading: None }
    }

    /// One that the heading at `place` states, Hz.
    pub(crate) fn heading(hz: f64, place: String) -> Self {
        let heading = Some(place);
        Self { hz, heading }
    }
}

/// Whether two sample rates are meant to be the same.
pub(crate) fn agree(a: f64, b: f64) -> bool {
    (a - b).abs() <= RATE_TOLERANCE * a.abs().max(b.abs())
}

/// Whether a number of this name is a sample rate, Hz.
pub(crate) fn is_sample_rate(name: &str) -> bool {
    let name = name.to_lowercase().replace('_', " ");
    RATES.contains(&name.strip_suffix(" hz").unwrap_or(&name))
}

/// The one sample rate that numbers of these names in a file state, Hz; none where there are no numbers.
///
/// # Errors
/// Rates that contradict each other, as a reason with their names.
pub(crate) fn only_rate(named: &[(&str, f64)]) -> Result<Option<f64>, String> {
    let Some((name, hz)) = named.first() else {
        return Ok(None);
    };
    match named.iter().find(|(_, other)| !agree(*hz, *other)) {
        None => Ok(Some(*hz)),
        Some((other, other_hz)) => Err(format!(
            "its sample rates contradict each other: `{name}` is {hz} Hz, `{other}` is {other_hz} Hz"
        )),
    }
}

/// Below this rate, Hz, what has no unit may be in another one: a number with a fraction in kHz, a time in milliseconds.
pub(crate) const CLEAR_FROM_HZ: f64 = 1000.0;

/// Why a number of this name and without a unit is no rate in Hz for certain; none where it is.
pub(crate) fn unclear_number(name: &str, hz: f64) -> Option<String> {
    let is_clear = hz.fract() == 0.0 || hz >= CLEAR_FROM_HZ || name.to_lowercase().ends_with("hz");
    (!is_clear).then(|| format!("`{name}` is {hz}, which may be in Hz or in kHz"))
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
    fn numbers_must_state_one_rate() {
        assert_eq!(only_rate(&[]), Ok(None));
        assert!(unclear_number("fs", 25.6).is_some());
        for (name, hz) in [("fs", 500.0), ("fs", 17_066.67), ("sample_rate_Hz", 25.6)] {
            assert_eq!(unclear_number(name, hz), None, "{name}");
        }
        assert_eq!(
            only_rate(&[("fs", 1000.0), ("sample_rate", 1001.0)]),
            Ok(Some(1000.0))
        );
        let error = only_rate(&[("fs", 1000.0), ("sample_rate", 2000.0)]).unwrap_err();
        assert!(
            error.contains("`fs` is 1000 Hz, `sample_rate` is 2000 Hz"),
            "{error}"
        );
    }

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
