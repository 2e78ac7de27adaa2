//! The schema of machine.yaml.

use super::generate::generate;
use super::node::Node;
use super::synonyms;
use crate::machine_file::Sections;
use serde_json::{Map, Value, json};
use std::sync::LazyLock;

/// The schema of the sections of a machine file, each of them whole.
pub(crate) static MACHINE: LazyLock<Value> = LazyLock::new(generate::<Sections>);

/// The top of the machine file.
pub(crate) fn machine() -> Node<'static> {
    Node::top(&MACHINE)
}

/// The schema of machine.yaml.
///
/// In a machine of several throws a section may be spread over the top and the throws, so that
/// its keys are required only in a machine of one.
pub fn machine_schema() -> Value {
    let mut schema = generate::<Sections>();
    schema["title"] = "machine.yaml".into();
    let mut defs = schema["$defs"].take();
    synonyms::add(&mut schema, &mut defs);
    let mut parts = Map::new();
    let mut strict = Map::new();
    for section in ["rod", "crosshead", "cylinder", "joints"] {
        let whole = schema["properties"][section].clone();
        schema["properties"][section] = loosen(&whole, &defs, &mut parts);
        strict.insert(section.to_owned(), whole);
        let of_throw = defs["ThrowSection"]["properties"][section].clone();
        defs["ThrowSection"]["properties"][section] = loosen(&of_throw, &defs, &mut parts);
    }
    defs["ThrowSection"]["required"] = json!(["name"]);
    if let Value::Object(defs) = &mut defs {
        defs.extend(parts);
    }
    schema["if"] = json!({"required": ["throws"]});
    schema["else"] = json!({
        "allOf": synonyms::needed(),
        "properties": strict,
    });
    schema["$defs"] = defs;
    schema
}

/// `schema` without required keys at any depth. Definitions that change are copied to `parts`.
fn loosen(schema: &Value, defs: &Value, parts: &mut Map<String, Value>) -> Value {
    match schema {
        Value::Array(items) => items.iter().map(|s| loosen(s, defs, parts)).collect(),
        Value::Object(keywords) => keywords
            .iter()
            .filter(|(keyword, value)| !(*keyword == "required" && value.is_array()))
            .map(
                |(keyword, value)| match (keyword.as_str(), value.as_str()) {
                    ("$ref", Some(target)) => (keyword.clone(), loosen_target(target, defs, parts)),
                    // Without required keys several alternatives fit.
                    ("oneOf", _) => ("anyOf".to_owned(), loosen(value, defs, parts)),
                    _ => (keyword.clone(), loosen(value, defs, parts)),
                },
            )
            .collect(),
        scalar => scalar.clone(),
    }
}

fn loosen_target(target: &str, defs: &Value, parts: &mut Map<String, Value>) -> Value {
    let name = target.trim_start_matches("#/$defs/");
    let loose = loosen(&defs[name], defs, parts);
    if loose == defs[name] {
        return target.into();
    }
    let part = format!("{name}Part");
    let target = format!("#/$defs/{part}");
    parts.insert(part, loose);
    target.into()
}
