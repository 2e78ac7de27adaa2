//! The synonyms of a machine file's keys, in its schema.

use crate::machine_file::synonyms::{Meaning, SYNONYMS, Synonym};
use serde_json::{Value, json};

/// Sections that a machine of one throw needs, or a synonym of something in each.
const NEEDED: [&str; 3] = ["rod", "crosshead", "cylinder"];

/// Adds the synonyms to the schema of a machine file, `schema` with the definitions `defs`, and takes away what is
/// required no longer where a synonym serves.
pub(super) fn add(schema: &mut Value, defs: &mut Value) {
    for synonym in SYNONYMS {
        let Some(target) = at(schema, defs, synonym.key).cloned() else {
            continue;
        };
        let described = described(synonym, target);
        let (above, name) = synonym.name.rsplit_once('.').unwrap_or(("", synonym.name));
        if let Some(section) = section_at(schema, defs, above) {
            section["properties"][name] = described.clone();
        }
        let of_throw = &mut defs["ThrowSection"]["properties"];
        // A throw has its crank radius under the name that is a synonym at the top.
        let is_key = of_throw.get(name).is_some();
        if above.is_empty() && !synonym.key.starts_with("speed") && !is_key {
            of_throw[name] = described;
        }
        let (above, key) = synonym.key.rsplit_once('.').unwrap_or(("", synonym.key));
        if !above.is_empty() {
            let section = section_at(schema, defs, above);
            let required = section.and_then(|s| s["required"].as_array_mut());
            required
                .into_iter()
                .for_each(|required| required.retain(|k| k != key));
        }
    }
    let required = schema["required"].as_array().cloned().unwrap_or_default();
    let (replaced, kept): (Vec<Value>, Vec<Value>) = required
        .into_iter()
        .partition(|key| key.as_str().is_some_and(|key| ways(key).len() > 1));
    schema["required"] = kept.into();
    let each = replaced.iter().filter_map(Value::as_str).map(any_of);
    schema["allOf"] = each.collect();
}

/// What a machine of one throw needs.
pub(super) fn needed() -> Value {
    NEEDED.iter().map(|key| any_of(key)).collect()
}

fn any_of(key: &str) -> Value {
    let ways: Vec<Value> = ways(key)
        .iter()
        .map(|way| json!({"required": [way]}))
        .collect();
    json!({"anyOf": ways})
}

/// The keys at the top by which something of the section `key` can be stated.
fn ways(key: &str) -> Vec<&str> {
    let within =
        |s: &&Synonym| s.key == key || s.key.strip_prefix(key).is_some_and(|r| r.starts_with('.'));
    let names = SYNONYMS.iter().filter(within).map(|s| s.name);
    let names = names.filter(|name| !name.contains('.'));
    std::iter::once(key).chain(names).collect()
}

fn described(synonym: &Synonym, target: Value) -> Value {
    let Synonym { key, meaning, .. } = synonym;
    let (words, mut schema) = match meaning {
        Meaning::Same => (format!("Another name of {key}."), target),
        Meaning::Half => (format!("Twice {key}."), target),
        Meaning::Rpm => (
            format!("The {key} as a number of revolutions a minute."),
            json!({"type": ["number", "string"]}),
        ),
        Meaning::Si => (
            format!("The {key} as a number, in the SI unit that ends the name."),
            json!({"type": ["number", "string"]}),
        ),
        Meaning::HalfSi => (
            format!("Twice the {key} as a number, in the SI unit that ends the name."),
            json!({"type": ["number", "string"]}),
        ),
        Meaning::OfStroke => {
            let words = format!(
                "Clearance volume in % of the swept volume of its chamber: {key} is that share of the stroke."
            );
            (words, json!({"type": "string", "examples": ["12 %"]}))
        }
    };
    schema["description"] = words.into();
    schema
}

/// The schema of the value at a dotted path.
fn at<'a>(schema: &'a mut Value, defs: &'a mut Value, key: &str) -> Option<&'a mut Value> {
    let (above, name) = key.rsplit_once('.').unwrap_or(("", key));
    section_at(schema, defs, above)?
        .get_mut("properties")?
        .get_mut(name)
}

/// The schema of the section at a dotted path, which a definition has.
fn section_at<'a>(schema: &'a mut Value, defs: &'a mut Value, key: &str) -> Option<&'a mut Value> {
    let mut target: Option<String> = None;
    for part in key.split('.').filter(|_| !key.is_empty()) {
        let section = match &target {
            None => &*schema,
            Some(name) => &defs[name],
        };
        target = Some(reference(&section["properties"][part])?);
    }
    match target {
        None => Some(schema),
        Some(name) => defs.get_mut(&name),
    }
}

/// The definition of a section that `schema` refers to, straight or as one of several alternatives.
fn reference(schema: &Value) -> Option<String> {
    let own = schema["$ref"]
        .as_str()
        .map(|r| r.trim_start_matches("#/$defs/").to_owned());
    let branches = schema["anyOf"].as_array().into_iter().flatten();
    let is_section = |name: &String| !name.starts_with("Ideal");
    own.or_else(|| branches.filter_map(reference).find(is_section))
}
