//! The committed JSON Schemas are the ones that the program gives.

use input::calibration;
use input::schema::{bundle_schema, machine_schema};
use serde_json::Value;
use std::path::PathBuf;

#[test]
fn the_committed_schemas_are_current() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data/schema");
    for (name, current) in [
        ("machine", machine_schema()),
        ("bundle", bundle_schema()),
        ("calibration", calibration::schema()),
    ] {
        let file = format!("{name}.schema.json");
        if std::env::var_os("UPDATE").is_some() {
            let text = serde_json::to_string_pretty(&current).unwrap();
            std::fs::write(folder.join(&file), text + "\n").unwrap();
        }
        let committed = std::fs::read_to_string(folder.join(&file)).unwrap_or_default();
        let committed: Value = serde_json::from_str(&committed).unwrap_or_default();
        assert!(
            committed == current,
            "data/schema/{file} is stale; rewrite it with\n    \
             UPDATE=1 cargo test -p crosshead-input --test all schema"
        );
    }
}

#[test]
fn every_reference_leads_to_a_definition() {
    fn check(node: &Value, root: &Value, seen: &mut usize) {
        if let Some(target) = node.get("$ref").and_then(Value::as_str) {
            let pointer = target.strip_prefix('#').unwrap();
            assert!(root.pointer(pointer).is_some(), "{target}");
            *seen += 1;
        }
        match node {
            Value::Object(section) => section.values().for_each(|v| check(v, root, seen)),
            Value::Array(items) => items.iter().for_each(|v| check(v, root, seen)),
            _ => {}
        }
    }
    for (schema, least) in [
        (machine_schema(), 50),
        (bundle_schema(), 3),
        (calibration::schema(), 3),
    ] {
        let mut seen = 0;
        check(&schema, &schema, &mut seen);
        assert!(seen >= least, "{seen}");
    }
}

#[test]
fn every_key_has_a_description() {
    fn check(node: &Value, at: &str, missing: &mut Vec<String>) {
        if let Some(properties) = node.get("properties").and_then(Value::as_object) {
            for (key, value) in properties {
                // Tags are described by the alternatives that they choose.
                if value.get("description").is_none() && value.get("const").is_none() {
                    missing.push(format!("{at}.{key}"));
                }
            }
        }
        if let Value::Object(section) = node {
            for (key, value) in section.iter().filter(|(key, _)| *key != "else") {
                check(value, &format!("{at}.{key}"), missing);
            }
        }
    }
    let mut missing = Vec::new();
    check(&machine_schema(), "", &mut missing);
    check(&calibration::schema(), "", &mut missing);
    assert_eq!(missing, [""; 0]);
}
