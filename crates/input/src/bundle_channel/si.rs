//! How the numbers of a channel become SI values.

use super::channel::Channel;
use crate::error::{Error, Problem};
use crate::kind::KINDS;
use crate::machine_file::unit_of_quantity;
use crate::recorded_unit::{RecordedUnit, recorded_unit};
use crate::unit::{self, Dimension, UnitError};
use mechanism::declaration::Quantity;

/// A number in the unit of a channel becomes one in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToSi {
    /// Added first, in the channel's unit.
    pub offset: f64,
    /// SI units in one of the channel's.
    pub scale: f64,
}

impl ToSi {
    /// The value in SI units.
    pub fn apply(self, value: f64) -> f64 {
        (value + self.offset) * self.scale
    }

    /// The value in the channel's unit.
    pub fn back(self, si: f64) -> f64 {
        si / self.scale - self.offset
    }
}

/// The unit and the offset of a channel whose name has no meaning: a gauge pressure with its ambient pressure is one in
/// the absolute unit. Without it, the unit stays as it is.
pub fn unit_as_stated(channel: &Channel) -> (&str, f64) {
    let offset = channel.offset.map_or(0.0, |offset| offset.get());
    match unit::gauge(channel.unit.trim()) {
        Some((_, absolute)) if channel.offset.is_some() => (absolute, offset),
        _ => (&channel.unit, offset),
    }
}

/// The standard atmosphere in the unit of a gauge; none for any other unit.
pub(crate) fn ambient_pressure(unit: &str) -> Option<f64> {
    let gauge = recorded_unit(unit, false).filter(|unit| unit.gauge)?;
    let ambient = unit::parse("1 atm").ok()?.si / gauge.si;
    Some((1e4 * ambient).round() / 1e4)
}

/// The dimension of a quantity, and what belongs in the place of a wrong unit.
fn unit_of(quantity: Quantity) -> (Dimension, String) {
    let (dimension, unit) = unit_of_quantity(quantity);
    let examples = match quantity {
        Quantity::Acceleration => "m/s2 or g",
        Quantity::Velocity => "mm/s or in/s",
        Quantity::Pressure => "Pa, bar or psi",
        Quantity::Angle => "rad or deg",
        _ => unit,
    };
    let kind = KINDS.iter().find(|kind| kind.dimension == dimension);
    let words = kind.map_or("a number", |kind| kind.words);
    (dimension, format!("{words}, e.g. {examples}"))
}

/// How numbers of a channel become the SI values of a quantity.
///
/// # Errors
/// A unit that is unknown or of another dimension; a gauge pressure without its ambient pressure.
pub(super) fn to_si(channel: &Channel, quantity: Quantity) -> Result<ToSi, Error> {
    let (dimension, expected) = unit_of(quantity);
    let text = channel.unit.trim();
    let refuse = |reason: String| Error::new("unit", Problem::Other(reason));
    // The full scale of a WAV file, `50 m/s2`, leads with a number.
    let (size, text) = match text.split_once(' ') {
        Some((size, unit)) if size.parse::<f64>().is_ok_and(f64::is_finite) => (size, unit.trim()),
        _ => ("1", text),
    };
    let recorded = recorded_unit(text, quantity == Quantity::Acceleration);
    if let Some(RecordedUnit {
        gauge: true, name, ..
    }) = &recorded
        && channel.offset.is_none()
    {
        return Err(refuse(format!(
            "{text} counts from the ambient pressure; give that as `offset`, in {name}, to make it absolute"
        )));
    }
    let (found, scale) = match recorded {
        Some(unit) => (unit.dimension, scaled(size, &unit)),
        None => match unit::parse(&format!("{size} {text}")) {
            Ok(measure) => (measure.dimension, measure.si),
            Err(UnitError::NoUnit) => return Err(refuse(format!("no unit; expected {expected}"))),
            Err(error) => return Err(refuse(format!("{error}; expected {expected}"))),
        },
    };
    if found != dimension {
        return Err(Error::unexpected(
            "unit",
            format!("'{}'", channel.unit),
            expected,
        ));
    }
    Ok(ToSi {
        offset: channel.offset.map_or(0.0, |offset| offset.get()),
        scale,
    })
}

/// SI units in so many of a unit; exactly the decimal number where the unit is one of files.
fn scaled(size: &str, unit: &RecordedUnit) -> f64 {
    let exact = unit::parse(&format!("{size} {}", unit.name)).ok();
    let exact = exact.filter(|measure| measure.dimension == unit.dimension);
    exact.map_or_else(
        || size.parse().unwrap_or(1.0) * unit.si,
        |measure| measure.si,
    )
}
