//! The measuring chain that the recordings show.

use super::verdict::quantity;
use super::{Converter, Noise, Sensor, words};
use crate::text;

/// The cells of a row: noise, share of 1/f, step, bits and range, sample rate.
pub(super) fn row(sensor: &Sensor) -> [String; 5] {
    let (_, unit) = words::column(&sensor.column);
    let percent = |share: f64| format!("{}\u{a0}%", text::number(100.0 * share, 2));
    let (noise, pink) = match &sensor.noise {
        Noise::Known {
            rms,
            of_signal,
            pink_share,
        } => {
            let of_signal = of_signal.map(|share| format!(", {} of the signal", percent(share)));
            (
                format!("{}{}", quantity(*rms, unit), of_signal.unwrap_or_default()),
                percent(*pink_share),
            )
        }
        Noise::AtMost { rms, reason } => (
            format!("at most {}: {reason}", quantity(*rms, unit)),
            String::new(),
        ),
        Noise::Unknown { reason } => (format!("not identifiable: {reason}"), String::new()),
    };
    let (step, bits) = match &sensor.converter {
        Converter::RangeAssumed {
            resolution,
            bits_needed,
            bits,
            range,
        } => (
            quantity(*resolution, unit),
            format!(
                "at least {bits_needed} bits; range not identifiable, assumed ±{} ({bits} bits)",
                quantity(*range, unit)
            ),
        ),
        Converter::RangePerRun {
            resolution,
            finest,
            bits,
        } => (
            format!(
                "{} to {}",
                quantity(*finest, unit),
                quantity(*resolution, unit)
            ),
            format!("{bits} bits, range set to each run"),
        ),
        Converter::Encoder { resolution, bits } => (
            quantity(*resolution, unit),
            format!("{bits} bits to the turn"),
        ),
        Converter::Unknown { reason } => (String::new(), format!("not identifiable: {reason}")),
    };
    let rate = sensor.sample_rate_hz;
    let rate = rate.map_or_else(|| "not known".to_owned(), |hz| quantity(hz, "Hz"));
    [noise, pink, step, bits, rate]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_assumed_range_is_called_so() {
        let sensor = Sensor {
            column: "crosshead_acceleration_m_s2".into(),
            noise: Noise::Known {
                rms: 4.78,
                of_signal: Some(0.02),
                pink_share: 0.3,
            },
            converter: Converter::RangeAssumed {
                resolution: 0.0625,
                bits_needed: 14,
                bits: 24,
                range: 524288.0,
            },
            sample_rate_hz: Some(20_000.0),
        };
        let [noise, pink, step, bits, rate] = row(&sensor);
        assert_eq!(noise, "4.78\u{a0}m/s², 2\u{a0}% of the signal");
        assert_eq!(pink, "30\u{a0}%");
        assert_eq!(step, "0.0625\u{a0}m/s²");
        assert!(bits.starts_with("at least 14 bits; range not identifiable, assumed ±"));
        assert_eq!(rate, "20\u{202f}000\u{a0}Hz");
    }

    #[test]
    fn what_is_unknown_has_its_reason() {
        let sensor = Sensor {
            column: "x".into(),
            noise: Noise::Unknown {
                reason: "too few revolutions".into(),
            },
            converter: Converter::Unknown {
                reason: "no lattice".into(),
            },
            sample_rate_hz: None,
        };
        let [noise, pink, step, bits, rate] = row(&sensor);
        assert_eq!(noise, "not identifiable: too few revolutions");
        assert_eq!(bits, "not identifiable: no lattice");
        assert_eq!([pink, step, rate], ["", "", "not known"]);
    }
}
