//! Sections at the top of a machine of several throws hold for each of them, key by key.

use crate::tree::{find, parents};
use serde_json::{Map, Value};
use std::borrow::Cow;

/// The sections that a throw shares.
const SECTIONS: [&str; 4] = ["rod", "crosshead", "cylinder", "housing"];
/// The joints that a throw shares.
const JOINTS: [&str; 3] = ["big_end", "small_end", "guide"];

/// The tree with the shared sections moved into every throw; the tree itself where it has no
/// list of throws.
pub(super) fn spread(tree: &Value) -> Cow<'_, Value> {
    if !tree["throws"].is_array() {
        return Cow::Borrowed(tree);
    }
    let mut tree = tree.clone();
    let shared = tree.as_object_mut().map(take_shared).unwrap_or_default();
    if let Some(throws) = tree["throws"].as_array_mut() {
        for throw in throws.iter_mut().filter(|throw| throw.is_object()) {
            let own = std::mem::take(throw);
            *throw = overlay(&Value::Object(shared.clone()), own);
        }
    }
    Cow::Owned(tree)
}

fn take_shared(tree: &mut Map<String, Value>) -> Map<String, Value> {
    let mut shared = take(tree, &SECTIONS);
    if let Some(Value::Object(joints)) = tree.get_mut("joints") {
        let joints = take(joints, &JOINTS);
        if !joints.is_empty() {
            shared.insert("joints".to_owned(), Value::Object(joints));
        }
    }
    shared
}

fn take(from: &mut Map<String, Value>, keys: &[&str]) -> Map<String, Value> {
    let entries = keys.iter().filter_map(|key| from.shift_remove_entry(*key));
    entries.collect()
}

/// `own` on top of `shared`. Sections that name another law or formula do not mix.
fn overlay(shared: &Value, own: Value) -> Value {
    let (Value::Object(below), Value::Object(above)) = (shared, &own) else {
        return own;
    };
    let differs = |tag: &str| {
        let ours = above.get(tag);
        ours.is_some() && ours != below.get(tag)
    };
    if differs("law") || differs("from") {
        return own;
    }
    let Value::Object(above) = own else {
        return own;
    };
    let mut merged = below.clone();
    for (key, value) in above {
        let value = match below.get(&key) {
            Some(shared) => overlay(shared, value),
            None => value,
        };
        merged.insert(key, value);
    }
    Value::Object(merged)
}

/// The key as the file has it: without its throw where only the shared section has it, or would have it.
pub(super) fn written_key<'a>(tree: &Value, key: &'a str) -> &'a str {
    let shared = key
        .strip_prefix("throws.")
        .and_then(|rest| rest.split_once('.'));
    // A pattern stands for every throw.
    let Some((_, rest)) = shared.filter(|(throw, _)| *throw != "*") else {
        return key;
    };
    let throw = &key[..key.len() - rest.len()];
    // What is no section that the throws share is the throw's own, as its name is.
    let top = rest.split('.').next().unwrap_or(rest);
    if top != "joints" && !SECTIONS.contains(&top) {
        return key;
    }
    // The nearest section that is there, in the throw or else in what the throws share.
    let section = parents(rest).find(|section| {
        let own = format!("{throw}{section}");
        find(tree, &own).or_else(|| find(tree, section)).is_some()
    });
    let is_own = |key: &str| find(tree, &format!("{throw}{key}")).is_some();
    match section {
        _ if is_own(rest) => key,
        _ if find(tree, rest).is_some() => rest,
        Some(section) if !is_own(section) => rest,
        _ => key,
    }
}
