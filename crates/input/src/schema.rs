//! JSON Schema of the machine file, for editors; and walking it, for messages and sweeps.

use crate::bundle_machine;
use crate::machine_file::Sections;
use crate::run_settings::{Joints, Load};
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::{Map, Value, json};
use std::sync::LazyLock;

/// The schema (draft 2020-12) of type `T`.
pub fn of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().with_transform(RecursiveTransform(tidy));
    let generator = settings.into_generator();
    generator.into_root_schema_for::<T>().to_value()
}

/// Takes out what serves no editor: null for a key that can as well be left out, and the line
/// breaks of descriptions.
fn tidy(schema: &mut Schema) {
    if let Some(Value::String(description)) = schema.get_mut("description") {
        *description = description.replace('\n', " ");
    }
    if schema.get("default").is_some_and(Value::is_null) {
        schema.remove("default");
    }
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|kind| kind != "null");
        if let [only] = &types[..] {
            let only = only.clone();
            schema.insert("type".to_owned(), only);
        }
    }
    if let Some(Value::Array(branches)) = schema.get_mut("anyOf") {
        branches.retain(|branch| branch["type"] != "null");
        if let [Value::Object(only)] = &mut branches[..] {
            let only = std::mem::take(only);
            schema.remove("anyOf");
            for (keyword, value) in only {
                let keywords = schema.ensure_object();
                keywords.entry(keyword).or_insert(value);
            }
        }
    }
}

/// The schema of machine.yaml.
///
/// In a machine of several throws a section may be spread over the top and the throws, so that
/// its keys are required only in a machine of one.
pub fn machine_schema() -> Value {
    let mut schema = of::<Sections>();
    schema["title"] = "machine.yaml".into();
    let mut defs = schema["$defs"].take();
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
        "required": ["rod", "crosshead", "cylinder"],
        "properties": strict,
    });
    schema["$defs"] = defs;
    schema
}

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
    let load = by_throw(part(of::<Load>()));
    let joints = by_throw(part(of::<Joints>()));
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "recordings.yaml",
        "description": "Measured runs of one machine. Values are SI; the unit ends the key.",
        "type": "object",
        "properties": {
            "format": {
                "description": "What the file is.",
                "const": crate::bundle::FORMAT,
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

/// Makes the tag of the first variant optional: it is the default.
pub(crate) fn default_variant(schema: &mut Schema) {
    if let Some(Value::Array(variants)) = schema.get_mut("oneOf")
        && let Some(Value::Array(required)) = variants.first_mut().map(|v| &mut v["required"])
        && !required.is_empty()
    {
        required.remove(0);
    }
}

static MACHINE: LazyLock<Value> = LazyLock::new(of::<Sections>);

/// A place in a schema: the alternatives that may stand there, references followed.
pub(crate) struct Node<'a> {
    root: &'a Value,
    alternatives: Vec<&'a Value>,
}

impl Node<'static> {
    /// The top of the machine file.
    pub(crate) fn machine() -> Self {
        Node::expand(&MACHINE, [&*MACHINE])
    }
}

impl<'a> Node<'a> {
    fn expand(root: &'a Value, schemas: impl IntoIterator<Item = &'a Value>) -> Self {
        let mut alternatives: Vec<&Value> = Vec::new();
        let mut open: Vec<&Value> = schemas.into_iter().collect();
        open.reverse();
        while let Some(schema) = open.pop() {
            let target = schema["$ref"].as_str().and_then(|r| r.strip_prefix('#'));
            open.extend(target.and_then(|target| root.pointer(target)));
            let branches = ["anyOf", "oneOf"].map(|k| schema[k].as_array());
            open.extend(branches.into_iter().flatten().flatten().rev());
            let says = schema.get("type").is_some() || schema.get("const").is_some();
            // Several alternatives may lead to one definition.
            if says && !alternatives.iter().any(|a| std::ptr::eq(*a, schema)) {
                alternatives.push(schema);
            }
        }
        Self { root, alternatives }
    }

    /// The keys that may stand here.
    pub(crate) fn keys(&self) -> Vec<&'a str> {
        let mut keys = Vec::new();
        for key in self.sections().flat_map(Map::keys) {
            if !keys.contains(&key.as_str()) {
                keys.push(key);
            }
        }
        keys
    }

    /// What may stand at `key`.
    pub(crate) fn key(&self, key: &str) -> Option<Self> {
        let schemas: Vec<&Value> = self.sections().filter_map(|s| s.get(key)).collect();
        (!schemas.is_empty()).then(|| Self::expand(self.root, schemas))
    }

    /// What may stand in the list that may stand here.
    pub(crate) fn items(&self) -> Option<Self> {
        let lists = self.alternatives.iter().filter_map(|s| s.get("items"));
        let schemas: Vec<&Value> = lists.collect();
        (!schemas.is_empty()).then(|| Self::expand(self.root, schemas))
    }

    /// What may stand at a dotted path of keys and indices.
    pub(crate) fn walk(self, path: &str) -> Option<Self> {
        path.split('.').try_fold(self, |node, part| {
            let index = part.parse::<usize>().is_ok();
            if index { node.items() } else { node.key(part) }
        })
    }

    /// What belongs here, in words; none where that depends on more than the place.
    pub(crate) fn expected(&self) -> Option<String> {
        let mut texts = self
            .alternatives
            .iter()
            .filter(|s| s.get("pattern").is_some());
        if let Some(text) = texts.next() {
            let only = texts.next().is_none();
            return text["description"]
                .as_str()
                .filter(|_| only)
                .map(str::to_owned);
        }
        let names = self.alternatives.iter().filter_map(|s| s["const"].as_str());
        let names: Vec<&str> = names.collect();
        if !names.is_empty() {
            return Some(format!("one of {}", names.join(", ")));
        }
        Some(match self.alternatives.first()?["type"].as_str()? {
            "object" => format!("a section with the keys {}", self.keys().join(", ")),
            "array" => "a list".to_owned(),
            "number" => "a plain number".to_owned(),
            "integer" => "a whole number".to_owned(),
            _ => "text".to_owned(),
        })
    }

    fn sections(&self) -> impl Iterator<Item = &'a Map<String, Value>> + '_ {
        self.alternatives
            .iter()
            .filter_map(|schema| schema["properties"].as_object())
    }
}
