//! The section that a sensor has in a machine file.

use super::section::{MEASURE, key};
use serde_json::{Map, Value, json};
use simulate::sensors::{Axis, ChamberEnd, Measured, PlaceKey};

/// The section of a perfect sensor of `measured` in a machine whose throws have these names (one
/// that is empty for a machine of one).
pub fn sensor_section(measured: Measured, throws: &[&str]) -> Map<String, Value> {
    let (entry, place) = (measured.entry(), measured.place());
    let mut section = Map::from_iter([(MEASURE.to_owned(), json!(entry.name))]);
    for at in entry.places {
        let word = match at {
            PlaceKey::Throw => throws.get(place.throw).copied().unwrap_or_default(),
            PlaceKey::Axis => match place.axis {
                Axis::X => "x",
                Axis::Y => "y",
            },
            PlaceKey::End => match place.end {
                // The default.
                ChamberEnd::Head => "",
                ChamberEnd::Crank => "crank",
            },
        };
        if !word.is_empty() {
            section.insert(key(*at).to_owned(), json!(word));
        }
    }
    section
}
