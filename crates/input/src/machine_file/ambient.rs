//! Pressures over the ambient one: `20 barg` with `ambient_pressure: 1.013 bar`.

use super::written::Written;
use crate::error::quoted;
use crate::quantity::{Kind, Positive, Pressure};
use crate::tree::{find, put};
use crate::unit::{Measure, parse_gauge};
use serde_json::Value;

/// The key of the ambient pressure.
const AMBIENT: &str = "ambient_pressure";

/// Keys of a cylinder that have absolute pressures.
const ABSOLUTE: [&str; 3] = ["suction", "discharge", "back"];

/// Makes the gauge pressures of the cylinders absolute, where the file states the ambient pressure.
pub(super) fn make_absolute(written: &mut Written) {
    let ambient = written.tree[AMBIENT].as_str();
    let Some(ambient) = ambient.and_then(|text| Positive::<Pressure>::parse(text).ok()) else {
        return;
    };
    let throws = written.tree["throws"].as_array().map_or(0, Vec::len);
    let throws = (0..throws).map(|i| format!("throws.{i}.cylinder"));
    for cylinder in std::iter::once("cylinder".to_owned()).chain(throws) {
        for key in ABSOLUTE {
            let key = format!("{cylinder}.{key}");
            let text = find(&written.tree, &key).and_then(Value::as_str);
            let Some(text) = text.map(str::to_owned) else {
                continue;
            };
            if let Some(above) = parse_gauge(&text) {
                let measure = Measure {
                    si: above + ambient.si(),
                    dimension: Pressure::DIMENSION,
                };
                put(&mut written.tree, &key, measure.to_string().into());
                let absolute = measure.si / 1e3;
                let own = format!("{} ({absolute:.3} kPa absolute)", quoted(&text));
                written.changed_from(&key, own);
            }
        }
    }
}
