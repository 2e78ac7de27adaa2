//! The schema of recordings.yaml.

use super::generate::generate;
use crate::bundle_machine;
use crate::run_settings::{Joints, Load};
use serde_json::{Value, json};

/// What the key `format` says of a file that this program reads.
pub(crate) const BUNDLE_FORMAT: &str = "clearance recordings 1";

/// The schema of a bundle's recordings.yaml.
pub fn bundle_schema() -> Value {
    let mut machine = bundle_machine::machine_schema();
    let by_throw = |part: Value| {
        json!({
            "description": "In a machine with several throws a section of these, by throw.",
            "anyOf": [part, {"type": "object", "additionalProperties": part}],
        })
    };
    let mut defs = machine["$defs"].take();
    let mut part = |mut part: Value| {
        if let (Value::Object(defs), Value::Object(own)) = (&mut defs, part["$defs"].take()) {
            defs.extend(own);
        }
        without_heading(part)
    };
    let load = by_throw(part(generate::<Load>()));
    let joints = by_throw(part(generate::<Joints>()));
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "recordings.yaml",
        "description": "Measured runs of one machine. Values are SI; the unit ends the key.",
        "type": "object",
        "properties": {
            "format": {
                "description": "What the file is.",
                "const": BUNDLE_FORMAT,
            },
            "machine": without_heading(machine),
            "runs": {
                "description": "The runs.",
                "type": "array",
                "minItems": 1,
                "items": {
                    "type": "object",
                    "properties": {
                        "id": text_of("Name of the run."),
                        "file": text_of("Its recording, a path from the folder on."),
                        "speed_rpm": above_zero("Measured mean speed."),
                        "speed_reference_rpm": above_zero(
                            "Speed at which the motor of a free crank gives its mean torque."),
                        "load": load,
                        "joints": joints,
                        "sample_rate_hz": above_zero("Samples per second."),
                        "samples": above_zero("Samples of every channel."),
                        "revolutions": above_zero("Revolutions that the recording covers."),
                        "channels": channels(),
                    },
                    "required": ["id", "file", "channels"],
                },
            },
        },
        "required": ["runs"],
        "$defs": defs,
    })
}

fn channels() -> Value {
    json!({
        "description": "The channels.",
        "type": "array",
        "minItems": 1,
        "items": {
            "type": "object",
            "properties": {
                "name": text_of("What it is, in words."),
                "column": text_of("Its column in the file."),
                "unit": text_of("Its unit, e.g. `m/s2`."),
                "offset": number(
                    "Added to its numbers, in its unit: the ambient pressure of a gauge."),
                "crank_angle_rad": number("Crank angle at which the pulse of a tacho comes."),
            },
            "required": ["column", "unit"],
        },
    })
}

fn text_of(description: &str) -> Value {
    json!({"description": description, "type": "string"})
}

fn number(description: &str) -> Value {
    json!({"description": description, "type": "number"})
}

fn above_zero(description: &str) -> Value {
    json!({"description": description, "type": "number", "exclusiveMinimum": 0})
}

/// A schema as a part of another.
fn without_heading(mut schema: Value) -> Value {
    if let Value::Object(keywords) = &mut schema {
        keywords.retain(|keyword, _| !["$schema", "title", "$defs"].contains(&keyword.as_str()));
    }
    schema
}
