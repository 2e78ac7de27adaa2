//! The measuring chain that the recordings show.

use super::verdict::quantity;
use super::words;
use calibrate::converter::Converter;
use calibrate::recorded_sensor::RecordedSensor;

/// The cells of a row: noise, share of 1/f, step, bits and range, sample rate.
pub(super) fn row(column: &str, sensor: &RecordedSensor) -> [String; 5] {
    let (_, unit) = words::column(column);
    let percent = |share: f64| format!("{}\u{a0}%", text::number(100.0 * share, 2));
    let found = &sensor.noise;
    let reason = found.noise_reason.as_deref().unwrap_or_default();
    let (noise, pink) = match (found.rms, found.at_most) {
        (Some(rms), _) => {
            let of_signal = found.of_signal;
            let of_signal = of_signal.map(|share| format!(", {} of the signal", percent(share)));
            (
                format!("{}{}", quantity(rms, unit), of_signal.unwrap_or_default()),
                percent(found.pink_share.unwrap_or(0.0)),
            )
        }
        (None, Some(rms)) => (
            format!("at most {}: {reason}", quantity(rms, unit)),
            String::new(),
        ),
        (None, None) => (format!("not identifiable: {reason}"), String::new()),
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
        Converter::Unknown { converter_reason } => (
            String::new(),
            format!("not identifiable: {converter_reason}"),
        ),
    };
    let rate = sensor.sample_rate_hz;
    let rate = rate.map_or_else(|| "not known".to_owned(), |hz| quantity(hz, "Hz"));
    [noise, pink, step, bits, rate]
}

#[cfg(test)]
mod tests {
    use super::*;
    use calibrate::recorded_sensor::RecordedNoise;

    #[test]
    fn an_assumed_range_is_called_so() {
        let sensor = RecordedSensor {
            noise: RecordedNoise {
                rms: Some(4.78),
                of_signal: Some(0.02),
                pink_share: Some(0.3),
                ..RecordedNoise::default()
            },
            converter: Converter::RangeAssumed {
                resolution: 0.0625,
                bits_needed: 14,
                bits: 24,
                range: 524288.0,
            },
            sample_rate_hz: Some(20_000.0),
        };
        let [noise, pink, step, bits, rate] = row("crosshead_acceleration_m_s2", &sensor);
        assert_eq!(noise, "4.78\u{a0}m/s², 2\u{a0}% of the signal");
        assert_eq!(pink, "30\u{a0}%");
        assert_eq!(step, "0.0625\u{a0}m/s²");
        assert!(bits.starts_with("at least 14 bits; range not identifiable, assumed ±"));
        assert_eq!(rate, "20\u{202f}000\u{a0}Hz");
    }

    #[test]
    fn what_is_unknown_has_its_reason() {
        let sensor = RecordedSensor {
            noise: RecordedNoise {
                noise_reason: Some("too few revolutions".into()),
                ..RecordedNoise::default()
            },
            converter: Converter::Unknown {
                converter_reason: "no lattice".into(),
            },
            sample_rate_hz: None,
        };
        let [noise, pink, step, bits, rate] = row("x", &sensor);
        assert_eq!(noise, "not identifiable: too few revolutions");
        assert_eq!(bits, "not identifiable: no lattice");
        assert_eq!([pink, step, rate], ["", "", "not known"]);
    }
}
