//! A `calibration.yaml` to fill in.

use super::comments::{Commented, commented};
use crate::calibration::schema;
use crate::error::Error;
use serde_json::json;

const HEAD: &str = "\
What is fitted to which recordings. `crosshead calibrate FILE --out calibrated` does it.
`crosshead check FILE` finds all mistakes at once.";

/// A `calibration.yaml` to fill in, for the bundle in `folder`.
///
/// # Errors
/// None in practice: the content can be written as YAML.
pub fn calibration(folder: &str) -> Result<String, Error> {
    let stiffness = json!({"bounds": ["2 GN/m^1.5", "200 GN/m^1.5"]});
    let damping = json!({"bounds": ["2e3 N s/m", "2e5 N s/m"]});
    let friction = json!({"bounds": [0.005, 0.2]});
    let tree = json!({
        "bundle": folder,
        "parameters": {
            "joints.big_end.contact.stiffness": stiffness,
            "joints.big_end.contact.damping": damping,
            "joints.big_end.friction.coefficient": friction,
            "joints.small_end.contact.stiffness": stiffness,
            "joints.small_end.contact.damping": damping,
            "joints.small_end.friction.coefficient": friction,
        },
        "optimiser": "default",
        "seed": 0,
    });
    commented(&Commented {
        tree: &tree,
        schema: &schema(),
        head: HEAD,
        note: &|_| None,
        optional: &|_| true,
    })
}
