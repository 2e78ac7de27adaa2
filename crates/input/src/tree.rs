//! Places in a tree, by dotted paths of keys and indices. A key may itself have dots in it, as the axes of a sweep
//! have: the longest key that fits is meant.

use serde_json::{Map, Value};

/// The node at a dotted path of keys and indices; the tree itself at the empty one.
pub(crate) fn find<'a>(tree: &'a Value, key: &str) -> Option<&'a Value> {
    if key.is_empty() {
        return Some(tree);
    }
    match tree {
        Value::Array(items) => {
            let (item, rest) = key.split_once('.').unwrap_or((key, ""));
            find(items.get(item.parse::<usize>().ok()?)?, rest)
        }
        Value::Object(section) => {
            let (name, rest) = first(section, key)?;
            find(section.get(name)?, rest)
        }
        _ => None,
    }
}

/// The longest key of `section` that `key` begins with, and what follows it.
pub(crate) fn first<'k>(section: &Map<String, Value>, key: &'k str) -> Option<(&'k str, &'k str)> {
    let ends = key.match_indices('.').map(|(at, _)| at);
    let mut longest_first = std::iter::once(key.len()).chain(ends.rev());
    let fits = longest_first.find(|end| section.contains_key(&key[..*end]))?;
    Some((&key[..fits], key[fits..].trim_start_matches('.')))
}

/// The section or list that has the last part of `key`, and that part.
fn holder<'a, 'k>(tree: &'a mut Value, key: &'k str) -> Option<(&'a mut Value, &'k str)> {
    let split = match &*tree {
        Value::Array(_) => key.split_once('.').unwrap_or((key, "")),
        Value::Object(section) => first(section, key)?,
        _ => return None,
    };
    match split {
        (name, "") => Some((tree, name)),
        (name, rest) => {
            let below = match tree {
                Value::Array(items) => items.get_mut(name.parse::<usize>().ok()?)?,
                tree => tree.get_mut(name)?,
            };
            holder(below, rest)
        }
    }
}

/// `a.b`, then `a`, of `a.b.c`.
pub(crate) fn parents(key: &str) -> impl Iterator<Item = &str> {
    std::iter::successors(key.rsplit_once('.'), |(parent, _)| parent.rsplit_once('.'))
        .map(|(parent, _)| parent)
}

/// Whether `key` is `section` or stands below it.
pub(crate) fn is_within(key: &str, section: &str) -> bool {
    let rest = key.strip_prefix(section);
    section.is_empty() || rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// `key` with `to` in the place of `from`, where it stands below that.
pub(crate) fn moved(key: &str, from: &str, to: &str) -> Option<String> {
    is_within(key, from).then(|| format!("{to}{}", &key[from.len()..]))
}

/// Puts `value` at `key`; sections on the way are made where nothing stands. False where something else does.
pub(crate) fn put(tree: &mut Value, key: &str, value: Value) -> bool {
    if key.is_empty() {
        *tree = value;
        return true;
    }
    if tree.is_null() {
        *tree = Value::Object(Map::new());
    }
    let next = key.split_once('.').unwrap_or((key, ""));
    match tree {
        Value::Array(items) => match next.0.parse::<usize>().ok().and_then(|i| items.get_mut(i)) {
            Some(item) => put(item, next.1, value),
            None => false,
        },
        Value::Object(section) => {
            let (name, rest) = first(section, key).unwrap_or(next);
            put(section.entry(name).or_insert(Value::Null), rest, value)
        }
        _ => false,
    }
}

/// The key itself, dots included, that the last part of `key` is or belongs to.
pub(crate) fn own_name(tree: &Value, key: &str) -> Option<String> {
    let mut copy = tree.clone();
    holder(&mut copy, key).map(|(_, name)| name.to_owned())
}

/// Takes out what stands at `key`.
pub(crate) fn take(tree: &mut Value, key: &str) -> Option<Value> {
    match holder(tree, key)? {
        (Value::Object(section), name) => section.shift_remove(name),
        (Value::Array(items), name) => {
            let index: usize = name.parse().ok()?;
            (index < items.len()).then(|| items.remove(index))
        }
        _ => None,
    }
}

/// Renames the key at `key` to `name`, which stays at its place in the order.
pub(crate) fn rename(tree: &mut Value, key: &str, name: &str) -> bool {
    let Some((Value::Object(section), old)) = holder(tree, key) else {
        return false;
    };
    if section.contains_key(name) || !section.contains_key(old) {
        return false;
    }
    let entries = std::mem::take(section).into_iter();
    *section = entries
        .map(|(key, value)| match key == old {
            true => (name.to_owned(), value),
            false => (key, value),
        })
        .collect();
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn keys_may_have_dots() {
        let mut tree = json!({"grid": {"a.b": 1, "a": {"c": [2, 3]}}});
        assert_eq!(find(&tree, "grid.a.b"), Some(&json!(1)));
        assert_eq!(find(&tree, "grid.a.c.1"), Some(&json!(3)));
        assert!(put(&mut tree, "grid.a.b", json!(4)));
        assert!(put(&mut tree, "grid.a.d.e", json!(5)));
        assert_eq!(take(&mut tree, "grid.a.c.0"), Some(json!(2)));
        assert!(rename(&mut tree, "grid.a.b", "z"));
        assert!(!put(&mut tree, "grid.z.y", json!(1)));
        assert_eq!(
            tree,
            json!({"grid": {"z": 4, "a": {"c": [3], "d": {"e": 5}}}})
        );
    }
}
