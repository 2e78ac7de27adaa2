//! The features of the channels of a window: their definitions and their values, from one table.

use crate::definition::Definition;
use crate::envelope::Envelope;
use crate::reason::Reason;
use crate::spectral;
use crate::statistics::Statistics;
use crate::table::{self, Line, Unit, Value};
use crate::window::{Window, has_features};
use signal::phase_portrait::PhasePortrait;
use signal::synchronous_average::SynchronousAverage;
use std::cell::LazyCell;

/// The columns that channels give, from their names and units.
pub fn definitions<'a>(channels: impl IntoIterator<Item = (&'a str, &'a str)>) -> Vec<Definition> {
    let measured = channels.into_iter().filter(|(name, _)| has_features(name));
    measured
        .flat_map(|(name, unit)| table::lines(unit).map(move |line| definition(name, unit, line)))
        .collect()
}

/// The features of a window, in the order of [`definitions`] of its channels: for each the value,
/// or why it has none.
pub fn features(window: &Window) -> Vec<Result<f64, Reason>> {
    let grid = LazyCell::new(|| spectral::angle_grid(window));
    let mut row = Vec::new();
    for channel in window.channels.iter().filter(|c| has_features(&c.name)) {
        let lines = table::lines(&channel.unit);
        let x: Vec<f64> = channel.samples.iter().map(|x| f64::from(*x)).collect();
        let statistics = match Statistics::new(&x) {
            Ok(statistics) => statistics,
            Err(reason) => {
                row.extend(lines.map(|_| Err(reason.clone())));
                continue;
            }
        };
        // Each analysis is made when the first line asks for it.
        let bands = LazyCell::new(|| spectral::bands(&x, window.sample_rate));
        let revolutions = LazyCell::new(|| Ok(held(&grid)?.resample(&x)?));
        let orders = LazyCell::new(|| spectral::Orders::new(held(&revolutions)?, held(&grid)?));
        let portrait = LazyCell::new(|| {
            let (revolutions, grid) = (held(&revolutions)?, held(&grid)?);
            Ok(PhasePortrait::new(revolutions, grid, window.sample_rate)?)
        });
        let shape = LazyCell::new(|| spectral::shape(&x, window.sample_rate, held(&grid)));
        let envelope = LazyCell::new(|| Envelope::new(&x, window.sample_rate, held(&grid)?));
        let synchronous = LazyCell::new(|| Ok(SynchronousAverage::new(held(&revolutions)?)?));
        let sectors = LazyCell::new(|| spectral::sectors(held(&revolutions)?, window));
        let overall = LazyCell::new(|| {
            let rate = window.sample_rate;
            Ok(spectral::overall_vibration(
                &x,
                &channel.unit,
                rate,
                held(&grid)?,
            )?)
        });
        let card = LazyCell::new(|| {
            spectral::card(&channel.name, held(&revolutions)?, held(&grid)?, window)
        });
        row.extend(lines.map(|line| match line.value {
            Value::Statistic(value) => value(&statistics),
            // What is left of a constant after filtering is rounding.
            _ if statistics.is_constant() => Err(Reason::Constant),
            Value::Band(index) => spectral::band(held(&bands)?, index, window.sample_rate),
            Value::Order(order) => held(&orders)?.of_mean(order),
            Value::OrderRms(order) => held(&orders)?.rms(order),
            Value::Portrait(value) => Ok(value(held(&portrait)?)?),
            Value::Shape(value) => Ok(value(held(&shape)?)),
            Value::Envelope(value) => Ok(value(held(&envelope)?)),
            Value::EnvelopeOrder(order) => Ok(held(&envelope)?.order(order)),
            Value::Synchronous(value) => Ok(value(held(&synchronous)?)?),
            Value::Sector(index) => Ok(held(&sectors)?[index]),
            Value::Cepstrum => spectral::cepstrum_at_revolution(held(&revolutions)?),
            Value::Overall(value) => Ok(value(held(&overall)?)),
            Value::Indicated(value) => Ok(value(held(&card)?)),
        }));
    }
    row
}

/// The result of an analysis, or a copy of the reason why there is none.
fn held<T>(analysis: &Result<T, Reason>) -> Result<&T, Reason> {
    analysis.as_ref().map_err(Reason::clone)
}

fn definition(channel: &str, channel_unit: &str, line: &Line) -> Definition {
    let unit = match line.unit {
        Unit::OfChannel => channel_unit,
        Unit::SquareOfChannel => squared(channel_unit),
        Unit::Pure => "1",
        Unit::Of(unit) => unit,
    };
    let stem = stem(channel, channel_unit);
    Definition {
        name: format!("{stem}.{}{}", line.name, ending(unit)),
        feature: line.name.clone(),
        group: line.value.group(),
        unit: unit.to_owned(),
        description: line.description.clone(),
        formula: line.formula,
        source: line.source,
    }
}

/// The square of the unit of a vibration.
fn squared(unit: &str) -> &'static str {
    match unit {
        "m/s" => "m^2/s^2",
        _ => "m^2/s^4",
    }
}

/// The name of a channel without its unit, which the names of its features begin with: `crosshead_acceleration` of
/// `crosshead_acceleration_m_s2`.
pub fn stem<'a>(channel: &'a str, unit: &str) -> &'a str {
    channel.strip_suffix(&ending(unit)).unwrap_or(channel)
}

/// How a column name ends for a unit: `_m_s2` for `m/s^2`, nothing for a pure number.
fn ending(unit: &str) -> String {
    if unit.is_empty() || unit == "1" {
        return String::new();
    }
    let letters = unit.chars().filter(|c| *c != '^').map(|c| match c {
        '/' | ' ' => '_',
        c => c.to_ascii_lowercase(),
    });
    std::iter::once('_').chain(letters).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn column_names_end_in_their_unit() {
        let channels = [
            ("crank_angle_rad", "rad"),
            ("throw1.crosshead_acceleration_m_s2", "m/s^2"),
            ("frame_velocity_x_m_s", "m/s"),
            ("cylinder_pressure_pa", "Pa"),
            ("torque_n_m", "N m"),
            ("Kanal 3", "V"),
        ];
        let definitions = definitions(channels);
        assert_eq!(definitions.len(), 93 + 62 + 52 + 10 + 10);
        let unit_of = |name: &str| {
            let found = definitions.iter().find(|d| d.name == name);
            found
                .unwrap_or_else(|| panic!("no column {name}"))
                .unit
                .as_str()
        };
        assert_eq!(unit_of("throw1.crosshead_acceleration.rms_m_s2"), "m/s^2");
        assert_eq!(unit_of("throw1.crosshead_acceleration.kurtosis"), "1");
        assert_eq!(
            unit_of("throw1.crosshead_acceleration.order_03_m_s2"),
            "m/s^2"
        );
        assert_eq!(
            unit_of("throw1.crosshead_acceleration.band_0020_0040_m2_s4"),
            "m^2/s^4"
        );
        assert_eq!(
            unit_of("throw1.crosshead_acceleration.band_2560_up_m2_s4"),
            "m^2/s^4"
        );
        assert_eq!(
            unit_of("throw1.crosshead_acceleration.portrait_area_m2_s3"),
            "m^2/s^3"
        );
        for (name, unit) in [
            ("envelope_centre_hz", "Hz"),
            ("envelope_order_5_m_s2", "m/s^2"),
            ("spectral_entropy", "1"),
            ("residual_rms_m_s2", "m/s^2"),
            ("sector_12_rms_m_s2", "m/s^2"),
            ("cepstrum_revolution", "1"),
            ("acceleration_rms_m_s2", "m/s^2"),
            ("velocity_rms_m_s", "m/s"),
            ("displacement_rms_m", "m"),
        ] {
            assert_eq!(
                unit_of(&format!("throw1.crosshead_acceleration.{name}")),
                unit
            );
        }
        assert_eq!(unit_of("frame_velocity_x.band_0000_0020_m2_s2"), "m^2/s^2");
        assert_eq!(unit_of("cylinder_pressure.mean_pa"), "Pa");
        assert_eq!(unit_of("cylinder_pressure.order_20_rms_pa"), "Pa");
        assert_eq!(unit_of("cylinder_pressure.indicated_power_w"), "W");
        assert_eq!(
            unit_of("cylinder_pressure.indicated_mean_pressure_pa"),
            "Pa"
        );
        assert_eq!(unit_of("torque.peak_n_m"), "N m");
        assert_eq!(unit_of("Kanal 3.skewness"), "1");
    }

    #[test]
    fn every_name_is_there_once() {
        let mut names: Vec<String> = definitions([("a_m_s2", "m/s^2"), ("p_pa", "Pa")])
            .into_iter()
            .map(|d| d.name)
            .collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
