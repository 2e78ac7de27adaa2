//! A value in the form that belongs at its place: a list for a section, a section for a list, one item for a list.

use crate::error::join;
use crate::schema::Node;
use serde_json::{Map, Value, json};

/// What was meant by a value of the wrong form.
pub(crate) enum Reshaped {
    /// One item in the place of a list of several.
    Guess(Value),
    /// All of it, with the old and the new key of each part.
    Parts(Value, Vec<(String, String)>),
}

/// `value` in the form that belongs at `place`, where that is another one:
///
/// 1. a list of the parts of a section becomes the section;
/// 2. a list where a value belongs becomes its first item;
/// 3. a section of named sections, where a list of sections with names belongs, becomes that list;
/// 4. another section where a list belongs becomes its only item.
pub(crate) fn reshaped(place: &Node, value: &Value) -> Option<Reshaped> {
    let is_section = !place.keys().is_empty();
    match (value, place.items()) {
        (Value::Array(items), None) if is_section => merged(place, items),
        (Value::Array(items), None) => {
            let first = items.first().filter(|first| !first.is_array())?;
            Some(Reshaped::Guess(first.clone()))
        }
        (Value::Object(section), Some(items)) if !is_section => {
            let are_sections = section.values().all(Value::is_object);
            match are_sections && items.has("name") {
                true => Some(named(section)),
                false => {
                    let parts = vec![(String::new(), "0".to_owned())];
                    Some(Reshaped::Parts(json!([section]), parts))
                }
            }
        }
        _ => None,
    }
}

/// One section of sections that have keys of `place`; the first of two equal keys counts.
fn merged(place: &Node, items: &[Value]) -> Option<Reshaped> {
    let mut whole = Map::new();
    let mut parts = Vec::new();
    for (i, item) in items.iter().enumerate() {
        for (key, value) in item.as_object()? {
            parts.push((join(&i.to_string(), key), key.clone()));
            whole.entry(key).or_insert(value.clone());
        }
    }
    let belongs = whole.keys().any(|key| place.has(key));
    belongs.then_some(Reshaped::Parts(whole.into(), parts))
}

/// A list of sections whose names were their keys.
fn named(sections: &Map<String, Value>) -> Reshaped {
    let mut parts = Vec::new();
    let items = sections.iter().enumerate().map(|(i, (name, content))| {
        parts.push((name.clone(), i.to_string()));
        let mut item = Map::from_iter([("name".to_owned(), json!(name))]);
        item.extend(content.as_object().cloned().unwrap_or_default());
        Value::Object(item)
    });
    let items = items.collect();
    Reshaped::Parts(items, parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_are_told_apart() {
        let schema = json!({"type": "object", "properties": {
            "rod": {"type": "object", "properties": {"mass": {"type": "string"}}},
            "throws": {"type": "array", "items": {"type": "object", "properties": {"name": {"type": "string"}}}},
            "sensors": {"type": "array", "items": {"type": "object", "properties": {"measure": {"type": "string"}}}},
            "speed": {"type": "string"},
        }});
        let of = |key: &str, value: Value| {
            let place = Node::top(&schema).key(key)?;
            Some(match reshaped(&place, &value)? {
                Reshaped::Guess(value) | Reshaped::Parts(value, _) => value,
            })
        };
        assert_eq!(
            of("rod", json!([{"mass": 1}, {"length": 2}])),
            Some(json!({"mass": 1, "length": 2}))
        );
        assert_eq!(of("rod", json!([1])), None);
        assert_eq!(of("rod", json!([{"suction": 1}])), None);
        assert_eq!(of("speed", json!(["1 rpm", "2 rpm"])), Some(json!("1 rpm")));
        assert_eq!(
            of("throws", json!({"a": {"x": 1}})),
            Some(json!([{"name": "a", "x": 1}]))
        );
        assert_eq!(
            of("sensors", json!({"measure": "x"})),
            Some(json!([{"measure": "x"}]))
        );
        assert_eq!(of("speed", json!("1 rpm")), None);
    }
}
