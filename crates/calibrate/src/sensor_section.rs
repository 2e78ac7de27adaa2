//! What recordings show of sensors, written into a machine file.

use crate::converter::{Converter, whole_bits};
use crate::error::Error;
use crate::problem::{measurable, names};
use crate::recorded_sensor::RecordedSensor;
use input::amount::Amount;
use input::unit;
use input::{MachineFile, sensor_section};
use serde_json::{Map, Value};
use simulate::{Measured, Range};
use std::collections::BTreeMap;

/// Digits of a written noise: its own accuracy has fewer.
const DIGITS: i32 = 4;

/// Gives the machine file `tree` the sensors that were `found`, by column, and their sample rate.
/// What was not found stays as the file has it. A channel without a sensor gets one.
///
/// # Errors
/// An invalid machine file.
pub fn write(
    tree: &mut Value,
    found: &BTreeMap<String, RecordedSensor>,
    sample_rate: Option<f64>,
) -> Result<(), Error> {
    let machine = MachineFile::from_tree(tree)?.resolve()?;
    let throws = names(&machine);
    let known = measurable(&machine)
        .into_iter()
        .chain([Measured::CrankAngle]);
    let known: Vec<(String, Measured)> = known.map(|m| (m.column(&throws), m)).collect();
    let mut sections = tree["sensors"].as_array().cloned().unwrap_or_default();
    for (column, sensor) in found {
        let Some((_, measured)) = known.iter().find(|(known, _)| known == column) else {
            continue;
        };
        let place = machine.sensors.iter().position(|s| s.measured == *measured);
        let place = place.unwrap_or_else(|| {
            sections.push(Value::Object(sensor_section(*measured, &throws)));
            sections.len() - 1
        });
        let chain = machine.sensors.get(place).map(|sensor| &sensor.chain);
        let stated = chain.and_then(|chain| match chain.range {
            Some(Range::Fixed(range)) => Some(range),
            Some(Range::Auto) | None => None,
        });
        if let Some(section) = sections[place].as_object_mut() {
            fill(section, sensor, *measured, stated);
        }
    }
    tree["sensors"] = sections.into();
    if let Some(rate) = sample_rate {
        tree["sample_rate"] = format!("{} Hz", rounded(rate, 9)).into();
    }
    Ok(())
}

/// Fills a section; `stated` is the range that it has, SI.
fn fill(
    section: &mut Map<String, Value>,
    sensor: &RecordedSensor,
    measured: Measured,
    stated: Option<f64>,
) {
    let dimension = unit::parse(&format!("1 {}", measured.unit())).ok();
    let dimension = dimension.map(|measure| measure.dimension);
    let amount = |si: f64| Amount { si, dimension }.to_value();
    let noise = &sensor.noise;
    if let Some(rms) = noise.rms {
        let level = match noise.of_signal {
            Some(share) => percent(share),
            None => amount(rounded(rms, DIGITS)),
        };
        let mut content = Map::from_iter([("rms".to_owned(), level)]);
        if let Some(share) = noise.pink_share.filter(|share| *share > 0.0) {
            content.insert("pink_share".into(), percent(share));
        }
        section.insert("noise".into(), content.into());
    }
    let (range, bits) = match sensor.converter {
        Converter::RangeAssumed {
            resolution,
            bits_needed,
            bits,
            range,
        } => {
            // A stated range stays where the recorded values fit into it in whole bits.
            let of_stated = stated.and_then(|range| whole_bits(2.0 * range, resolution));
            match of_stated.filter(|bits| *bits >= bits_needed) {
                Some(bits) => (None, bits),
                None => (Some(amount(range)), bits),
            }
        }
        Converter::RangePerRun { bits, .. } => (Some("auto".into()), bits),
        // The range of an encoder is its turn.
        Converter::Encoder { bits, .. } => (None, bits),
        Converter::Unknown { .. } => return,
    };
    if let Some(range) = range {
        section.insert("range".into(), range);
    }
    section.insert("bits".into(), bits.into());
}

fn percent(share: f64) -> Value {
    format!("{} %", rounded(100.0 * share, DIGITS)).into()
}

/// `x` to so many digits.
fn rounded(x: f64, digits: i32) -> f64 {
    let text = format!("{x:.*e}", (digits - 1) as usize);
    text.parse().unwrap_or(x)
}
