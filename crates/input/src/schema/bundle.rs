//! The schema of recordings.yaml.

use super::generate::generate;
use super::machine::machine_schema;
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
    let of_people = machine_file(&mut defs);
    let mut machine = without_heading(machine);
    let description = "The machine: SI values with the unit at the end of the key, or the keys of a machine file.";
    machine = json!({"description": description, "anyOf": [machine, of_people]});
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
            "machine": machine,
            "runs": {
                "description": "The runs.",
                "type": "array",
                "minItems": 1,
                "items": {
                    "type": "object",
                    "properties": {
                        "id": text_of("Name of the run."),
                        "file": text_of("Its recording, a path from the folder on."),
                        "files": files(),
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
                    "required": ["id", "channels"],
                    "oneOf": [{"required": ["file"]}, {"required": ["files"]}],
                },
            },
        },
        "required": ["runs"],
        "$defs": defs,
    })
}

/// A machine section with the keys of a machine file, none of which is needed: a run may set it. Its definitions go to
/// `defs` under names of their own.
fn machine_file(defs: &mut Value) -> Value {
    let mut schema = optional(machine_schema());
    let own = schema["$defs"].take();
    if let (Value::Object(defs), Value::Object(own)) = (defs, own) {
        defs.extend(
            own.into_iter()
                .map(|(name, schema)| (format!("{PREFIX}{name}"), schema)),
        );
    }
    schema["properties"]["type"] = text_of("What kind of machine it is, in words.");
    without_heading(schema)
}

/// Begins the names of definitions of the machine file.
const PREFIX: &str = "MachineFile";

/// `schema` without keys that are needed.
fn optional(schema: Value) -> Value {
    match schema {
        Value::Array(items) => items.into_iter().map(optional).collect(),
        Value::Object(keywords) => {
            let kept = keywords
                .into_iter()
                .filter(|(keyword, value)| match keyword.as_str() {
                    "required" | "allOf" => !value.is_array(),
                    "if" | "else" => false,
                    _ => true,
                });
            let kept = kept.map(|(keyword, value)| match (keyword.as_str(), value) {
                ("$ref", Value::String(target)) => (
                    keyword,
                    target
                        .replace("#/$defs/", &format!("#/$defs/{PREFIX}"))
                        .into(),
                ),
                // Without needed keys several alternatives fit.
                ("oneOf", value) => ("anyOf".to_owned(), optional(value)),
                (_, value) => (keyword, optional(value)),
            });
            Value::Object(kept.collect())
        }
        other => other,
    }
}

fn files() -> Value {
    let file = "The recording, a path from the folder on.";
    json!({
        "description": "Its recordings where it has several, in the place of `file`: each of them a path, or a \
            section with `file` and `start_s`. All have one sample rate. They are aligned by their times; a file \
            without a column of time needs start_s.",
        "type": "array",
        "minItems": 1,
        "items": {"anyOf": [
            {"type": "string"},
            {
                "type": "object",
                "properties": {
                    "file": text_of(file),
                    "start_s": number("Time of its first sample on the clock that the files of the run share, s."),
                },
                "required": ["file"],
                "additionalProperties": false,
            },
        ]},
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
                "unit": {"description": "Its unit, e.g. `m/s2`.", "type": "string", "examples": ["m/s2"]},
                "file": text_of("Its file, where the run has several."),
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
