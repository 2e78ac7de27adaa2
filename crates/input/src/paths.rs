//! Dotted paths into a machine file's tree, for sweeps: `joints.big_end.clearance`.
//!
//! A part is a key, an index of a list (`sensors.0.noise.rms`), or the name of an item: a throw's
//! (`throws.throw1.joints.big_end.clearance`), an effect's (`effects.valve_loss.discharge`), or
//! what a sensor measures (`sensors.cylinder_pressure.range`; the first of several).

use crate::amount::Amount;
use crate::error::{Error, Problem, shown};
use crate::machine_file::effects::{self, Entry};
use crate::machine_file::synonyms;
use crate::schema::{self, Node};
use crate::tree::find;
use serde_json::{Map, Value};

/// Puts `value` at `path`, whether or not the file has the key.
///
/// The path is checked, the value is not: reading the tree does that.
///
/// # Errors
/// Where the format has no such path, the file has no such list item, or a word such as `ideal`
/// stands where the path needs a section.
pub fn set(tree: &mut Value, path: &str, value: Value) -> Result<(), Error> {
    let keys = resolve(tree, path)?;
    let mut node = tree;
    for (depth, key) in keys.iter().enumerate() {
        node = match node {
            Value::Array(items) => key
                .parse::<usize>()
                .ok()
                .and_then(|index| items.get_mut(index))
                .ok_or_else(|| Error::missing(keys[..=depth].join(".")))?,
            Value::Object(section) => section.entry(key).or_insert(Value::Null),
            other => {
                if !other.is_null() {
                    let at = keys[..depth].join(".");
                    let expected = format!("a section, so that {path} can be set");
                    return Err(Error::unexpected(at, shown(other), expected));
                }
                *other = Value::Object(Map::new());
                &mut other[key.as_str()]
            }
        };
    }
    *node = value;
    Ok(())
}

/// `path` as keys and indices, the names of list items replaced: two ways of writing one path
/// give the same.
///
/// # Errors
/// Where the format has no such path or the file has no such list item.
pub fn keys(tree: &Value, path: &str) -> Result<Vec<String>, Error> {
    resolve(tree, path)
}

/// The value at `path`; of a throw that does not have it, the one that the throws share.
///
/// # Errors
/// Where the format has no such path or the file has no such list item.
pub fn get<'a>(tree: &'a Value, path: &str) -> Result<Option<&'a Value>, Error> {
    let key = resolve(tree, path)?.join(".");
    let shared = key
        .strip_prefix("throws.")
        .and_then(|rest| rest.split_once('.'))
        .and_then(|(_, rest)| find(tree, rest));
    Ok(find(tree, &key).or(shared))
}

/// The paths with a value that `pattern` stands for, in which a part may be `*`: any key, or any
/// item of a list. A pattern without one stands for itself.
///
/// # Errors
/// Where the format has no such path for any value of `*`.
pub fn matching(tree: &Value, pattern: &str) -> Result<Vec<String>, Error> {
    let parts: Vec<&str> = pattern.split('.').collect();
    let Some(star) = parts.iter().position(|part| *part == "*") else {
        let there = get(tree, pattern)?.is_some();
        return Ok(there.then(|| pattern.to_owned()).into_iter().collect());
    };
    let mut found = Vec::new();
    let mut refused = None;
    let names = names(tree, &parts[..star])?;
    for name in &names {
        let mut parts = parts.clone();
        parts[star] = name;
        match matching(tree, &parts.join(".")) {
            Ok(paths) => found.push(paths),
            // An item need not have what another has.
            Err(error) => refused = Some(error),
        }
    }
    match refused {
        Some(error) if found.is_empty() => Err(error),
        _ => Ok(found.concat()),
    }
}

/// The keys that may stand at the path `above`, or the items that the list there has.
fn names(tree: &Value, above: &[&str]) -> Result<Vec<String>, Error> {
    let walked = walk(tree, above.iter().copied())?;
    if walked.schema.items().is_none() {
        let keys = walked.schema.keys().into_iter();
        return Ok(keys.map(str::to_owned).collect());
    }
    let items = walked.node.and_then(Value::as_array).into_iter().flatten();
    let name = |(index, item): (usize, &Value)| {
        let name = item["name"].as_str().map(str::to_owned);
        name.unwrap_or_else(|| index.to_string())
    };
    Ok(items.enumerate().map(name).collect())
}

/// The path as keys and indices, names of list items replaced.
fn resolve(tree: &Value, path: &str) -> Result<Vec<String>, Error> {
    Ok(walk(tree, path.split('.'))?.keys)
}

/// A place of a file.
struct Walked<'a> {
    /// Its path in keys and indices.
    keys: Vec<String>,
    /// What the format has there.
    schema: Node<'static>,
    /// What the file has there.
    node: Option<&'a Value>,
}

fn walk<'a, 'p>(
    tree: &'a Value,
    parts: impl Iterator<Item = &'p str>,
) -> Result<Walked<'a>, Error> {
    let mut keys: Vec<String> = Vec::new();
    let mut schema = schema::machine();
    let mut node = Some(tree);
    for part in parts {
        let here = keys.join(".");
        if let Some(items) = schema.items() {
            let list = node
                .and_then(Value::as_array)
                .map_or(&[][..], Vec::as_slice);
            let (index, below) = item(list, part).map_err(|error| {
                let unlisted = effects::entry(part).filter(|_| here == "effects");
                unlisted.map_or(error, unlisted_effect).under(here)
            })?;
            keys.push(index.to_string());
            node = list.get(index);
            schema = items;
            if !below {
                continue;
            }
        }
        let Some(inner) = schema.key(part) else {
            return Err(unknown(part, &schema, &keys));
        };
        keys.push(part.to_owned());
        node = node.and_then(|node| node.get(part));
        schema = inner;
    }
    Ok(Walked { keys, schema, node })
}

/// `entry` is an effect that the file does not list.
fn unlisted_effect(entry: &Entry) -> Error {
    let required = entry.places.iter().filter(|choice| choice.required);
    let place = required.filter_map(|choice| {
        let word = choice.words.first()?;
        Some(format!("{}: {word}", choice.key))
    });
    let size = entry.amplitudes().next().into_iter();
    let size = size.map(|p| format!("{}: {}", p.key, shown_plain(&p.value(p.start))));
    let section: Vec<String> = place.chain(size).collect();
    let expected = format!(
        "it in the list effects of the machine file, e.g. '- {}: {{{}}}'",
        entry.name,
        section.join(", ")
    );
    Error::unexpected(
        entry.name,
        "an effect that the machine file does not list",
        expected,
    )
}

/// A value as it stands in a file.
fn shown_plain(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}

/// `part` is no key of `schema`, which describes what stands at `keys`.
fn unknown(part: &str, schema: &Node, keys: &[String]) -> Error {
    let error = Error::unknown_key(part, &schema.keys()).under(keys.join("."));
    match synonyms::instead(error.key()) {
        Some(words) => {
            let words = format!("unknown key; give {words}");
            Error::new(error.key(), Problem::Other(words))
        }
        None => error,
    }
}

/// The number that belongs at `path` of a machine file, whatever throws, sensors and effects that has: in words, and
/// as an example. None where the path has a `*`, or leads to something else.
///
/// # Errors
/// Where the format has no such path.
pub fn expected(path: &str) -> Result<Option<(String, Amount)>, Error> {
    let mut keys: Vec<String> = Vec::new();
    let mut schema = schema::machine();
    for part in path.split('.') {
        if part == "*" {
            return Ok(None);
        }
        schema = match schema.items() {
            // An effect has its name as a key, other items are named within.
            Some(items) => items.key(part).unwrap_or(items),
            None => schema
                .key(part)
                .ok_or_else(|| unknown(part, &schema, &keys))?,
        };
        keys.push(part.to_owned());
    }
    let example = schema.values().iter().find_map(Amount::from_value);
    Ok(example.map(|example| {
        let words = || format!("a value of its kind, e.g. {}", example.to_value());
        (schema.expected().unwrap_or_else(words), example)
    }))
}

/// The index of the item that `part` is the index or the name of, and whether its name is a key
/// that the item's content stands below.
fn item(list: &[Value], part: &str) -> Result<(usize, bool), Error> {
    if let Ok(index) = part.parse::<usize>()
        && index < list.len()
    {
        return Ok((index, false));
    }
    let mut names = Vec::new();
    for (index, item) in list.iter().enumerate() {
        let name = item["name"].as_str().or(item["measure"].as_str());
        if name == Some(part) {
            return Ok((index, false));
        }
        if name.is_none() && item.get(part).is_some() {
            return Ok((index, true));
        }
        let key = item.as_object().and_then(|section| section.keys().next());
        names.extend(name.or(key.map(String::as_str)));
    }
    Err(Error::unknown_name(part, part, &names))
}
