//! All mistakes of a file in one reading.
//!
//! A reader stops at the first mistake. Here the mistake is noted and taken out of the tree: an unknown key is
//! renamed to the nearest known one or goes, a wrong or missing value gets one that the schema allows. Then the
//! tree is read again. What a value that nobody wrote clashes with is no mistake of the file, and is not reported.

use crate::error::{Error, Problem, join, nearest as similar};
use crate::form::{Reshaped, reshaped};
use crate::schema::Node;
use crate::tree::{find, first, is_within, moved, own_name, parents, put, rename, take};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Readings after which the rest stays unreported: a file of so many mistakes is read again anyway.
const READINGS: usize = 600;

/// Values that all readings together go through at most, so that a large file takes no longer.
const VALUES: usize = 2_000_000;

/// All mistakes that `read` finds in `tree`, whose form is that of `schema`, in the order of reading. Keys of an
/// error, and those that it was held against, are those of the tree that was read. `canonical` gives the name that
/// the schema has for a key. With them comes the tree without the mistakes, as far as they could be taken out.
pub(crate) fn all(
    tree: &Value,
    schema: &Value,
    canonical: &dyn Fn(&str) -> String,
    read: &mut dyn FnMut(&Value) -> Result<(), Error>,
) -> (Vec<Error>, Value) {
    let mut repair = Repair {
        tree: tree.clone(),
        schema,
        canonical,
        made: BTreeSet::new(),
        guessed: BTreeSet::new(),
        tries: BTreeMap::new(),
        changes: Vec::new(),
    };
    let mut found: Vec<Error> = Vec::new();
    for _ in 0..(VALUES / size(tree)).clamp(1, READINGS) {
        let Err(error) = read(&repair.tree) else {
            break;
        };
        let mut goes_on = false;
        for error in error.into_each() {
            let changes = repair.changes.len();
            let is_mine = error.file().is_none();
            let original = repair.original(error.key());
            if !(is_mine && repair.is_made(&error)) {
                let error = match is_mine {
                    true => repair.placed(error.clone()).with_key(original),
                    false => error.clone(),
                };
                if !found.contains(&error) {
                    found.push(error);
                }
            }
            goes_on |= is_mine && repair.take_out(&error);
            // The keys of the other mistakes may have changed; they are found again.
            if repair.changes.len() > changes {
                break;
            }
        }
        if !goes_on {
            break;
        }
    }
    (found, repair.tree)
}

/// Number of values in a tree.
fn size(tree: &Value) -> usize {
    1 + match tree {
        Value::Array(items) => items.iter().map(size).sum(),
        Value::Object(section) => section.values().map(size).sum(),
        _ => 0,
    }
}

/// A tree on its way to one without mistakes.
struct Repair<'a> {
    tree: Value,
    schema: &'a Value,
    canonical: &'a dyn Fn(&str) -> String,
    /// Keys of values that nobody wrote.
    made: BTreeSet<String>,
    /// Keys of names that were misspelt, and are guessed.
    guessed: BTreeSet<String>,
    /// How often each key was repaired.
    tries: BTreeMap<String, usize>,
    changes: Vec<Change>,
}

/// Where a key belongs that is unknown where it stands.
enum Home {
    /// What stands in it belongs in the section about it.
    Above(String),
    /// In the section of this name; at the top where that is empty.
    In(String),
}

impl Home {
    fn words(&self) -> String {
        match self {
            Self::Above(above) if above.is_empty() => {
                "its keys belong at the top of the file".to_owned()
            }
            Self::Above(above) => format!("its keys belong in {above}"),
            Self::In(place) if place.is_empty() => "it belongs at the top of the file".to_owned(),
            Self::In(place) => format!("it belongs in {place}"),
        }
    }
}

/// Stands for an item of a list that is gone.
const GONE: &str = "-";

/// What was changed in the order of things, so that keys can be told as they were.
enum Change {
    /// A key has another name.
    Renamed { from: String, to: String },
    /// An item of a list is gone.
    Removed { list: String, index: usize },
}

impl Repair<'_> {
    /// Whether `error` comes from a value that nobody wrote.
    fn is_made(&self, error: &Error) -> bool {
        let is_in = |key: &str, made: &BTreeSet<String>| made.iter().any(|m| fits_within(key, m));
        let mut partners = error.partners();
        // What is wrong with a section may be wrong with a value in it.
        let has_made = |key: &str| !key.is_empty() && self.made.iter().any(|m| is_within(m, key));
        is_in(error.key(), &self.made)
            || has_made(error.key())
            || partners.any(|key| is_in(key, &self.made) || is_in(key, &self.guessed))
    }

    /// The key that stands in the file for `key` of the tree.
    fn original(&self, key: &str) -> String {
        let mut key = key.to_owned();
        for change in self.changes.iter().rev() {
            key = match change {
                Change::Renamed { from, to } => moved(&key, to, from).unwrap_or(key),
                Change::Removed { list, index } => later(&key, list, *index).unwrap_or(key),
            };
        }
        key
    }

    /// An unknown key with the words for where it belongs.
    fn placed(&self, error: Error) -> Error {
        let home = match error.problem() {
            Problem::UnknownKey { nearest: None, .. } => self.home(error.key()),
            _ => None,
        };
        match home {
            Some(home) => error.belonging(&home.words()),
            None => error,
        }
    }

    /// Where the unknown `key`, or what stands in it, belongs.
    fn home(&self, key: &str) -> Option<Home> {
        let own = own_name(&self.tree, key)?;
        let above = above(key, &own).to_owned();
        let schema = Node::top(self.schema);
        let parent = walk(
            Node::top(self.schema),
            Some(&self.tree),
            &(self.canonical)(&above),
        )?;
        let content = find(&self.tree, key).and_then(Value::as_object);
        let mut inner = content.into_iter().flat_map(|content| content.keys());
        if content.is_some_and(|content| !content.is_empty()) && inner.all(|name| parent.has(name))
        {
            return Some(Home::Above(above));
        }
        // An item of a list has its keys in its own section.
        if above.split('.').any(|part| part.parse::<usize>().is_ok()) {
            return None;
        }
        let sections = schema.keys().into_iter();
        let sections = sections.filter(|name| schema.key(name).is_some_and(|s| s.has(&own)));
        let top = schema.has(&own).then_some("");
        let mut places = top
            .into_iter()
            .chain(sections)
            .filter(|place| *place != above);
        let only = places.next()?.to_owned();
        let is_only = places.next().is_none();
        let is_there = find(&self.tree, &only).is_some();
        (is_only && is_there && self.is_free(&join(&only, &own))).then_some(Home::In(only))
    }

    /// Whether nobody wrote something at `key`.
    fn is_free(&self, key: &str) -> bool {
        find(&self.tree, key).is_none() || self.made.contains(key)
    }

    /// Puts an unknown key, or what stands in it, where it belongs.
    fn bring(&mut self, key: &str, home: &Home) -> bool {
        let own = own_name(&self.tree, key).unwrap_or_default();
        let Some(content) = take(&mut self.tree, key) else {
            return false;
        };
        let moves: Vec<(String, String, Value)> = match (home, content) {
            (Home::Above(above), Value::Object(content)) => content
                .into_iter()
                .map(|(name, value)| (join(key, &name), join(above, &name), value))
                .collect(),
            (Home::In(place), content) => vec![(key.to_owned(), join(place, &own), content)],
            (Home::Above(_), _) => Vec::new(),
        };
        for (from, to, value) in moves {
            if self.is_free(&to) && put(&mut self.tree, &to, value) {
                self.made.remove(&to);
                self.changes.push(Change::Renamed { from, to });
            }
        }
        true
    }

    /// Gives what stands at `key` the form that belongs there: see [`reshaped`].
    fn reshape(&mut self, key: &str) -> bool {
        let (Some(place), Some(value)) = (self.place(key), find(&self.tree, key)) else {
            return false;
        };
        match reshaped(&place, value) {
            None => false,
            Some(Reshaped::Guess(value)) => self.make(key, value),
            Some(Reshaped::Parts(value, parts)) => {
                let moves = parts.into_iter().map(|(from, to)| Change::Renamed {
                    from: join(key, &from),
                    to: join(key, &to),
                });
                self.changes.extend(moves);
                put(&mut self.tree, key, value)
            }
        }
    }

    /// Takes the mistake out of the tree; false where that cannot be done.
    fn take_out(&mut self, error: &Error) -> bool {
        let key = error.key();
        let tries = self.tries.entry(key.to_owned()).or_default();
        *tries += 1;
        let tries = *tries;
        if tries == 1 && matches!(error.problem(), Problem::Found { .. }) && self.reshape(key) {
            return true;
        }
        match error.problem() {
            Problem::UnknownKey { nearest, .. } => self.take_out_key(key, nearest.as_deref()),
            Problem::UnknownName { nearest, known, .. } => {
                let others = known.iter().filter(|name| Some(*name) != nearest.as_ref());
                let names: Vec<&String> = nearest.iter().chain(others).collect();
                let is_misspelt = tries == 1 && nearest.is_some();
                match names.get(tries - 1) {
                    Some(name) => self.rename_value(key, name, is_misspelt),
                    None => self.remove(key),
                }
            }
            Problem::Unreadable(_) | Problem::Syntax(_) | Problem::Empty | Problem::Duplicate => {
                false
            }
            Problem::Found { .. } | Problem::Missing { .. } | Problem::Other(_) => {
                let values = self.values(key);
                match values.get(tries - 1) {
                    Some(value) => {
                        self.doubt_section(key);
                        self.make(key, value.clone())
                    }
                    None => self.remove(key) || self.remove_section(key),
                }
            }
        }
    }

    /// What may stand at `key`, as far as the schema says.
    fn values(&self, key: &str) -> Vec<Value> {
        let mut values = self.place(key).map_or(Vec::new(), |place| place.values());
        if (self.canonical)(key) != key {
            // Some synonyms are plain numbers.
            values.extend([json!(0.1), json!(1)]);
        }
        values
    }

    /// The place of `key` in the schema.
    fn place(&self, key: &str) -> Option<Node<'_>> {
        let canonical = (self.canonical)(key);
        match canonical.as_str() {
            "" => None,
            other => walk(Node::top(self.schema), Some(&self.tree), other),
        }
    }

    /// Where `key` names the law or the quantity that its section is about, a name that nobody wrote leaves open what
    /// belongs in the section.
    fn doubt_section(&mut self, key: &str) {
        let is_tag = self.place(key).is_some_and(|place| place.is_tag());
        if let (true, Some(section)) = (is_tag, parents(key).next()) {
            self.made.insert(section.to_owned());
        }
    }

    /// Notes that nobody wrote what stands at `key`, under its name in the schema, too.
    fn note_made(&mut self, key: &str) {
        self.made.insert(key.to_owned());
        self.made.insert((self.canonical)(key));
    }

    fn make(&mut self, key: &str, value: Value) -> bool {
        self.note_made(key);
        if put(&mut self.tree, key, value.clone()) {
            return true;
        }
        // Something else than a section stands in the way.
        let Some(above) = parents(key).next().map(str::to_owned) else {
            return false;
        };
        self.made.insert(above.clone());
        put(&mut self.tree, &above, json!({})) && put(&mut self.tree, key, value)
    }

    fn take_out_key(&mut self, key: &str, nearest: Option<&str>) -> bool {
        if let Some(home) = nearest.is_none().then(|| self.home(key)).flatten() {
            return self.bring(key, &home);
        }
        let own = own_name(&self.tree, key).unwrap_or_default();
        let above = above(key, &own);
        // The name of a value may be wrong in the place of that of its key.
        let is_key = |name: &&str| own.contains('.') || similar(&own, [*name]).is_some();
        let name = nearest.filter(is_key).map(|name| corrected(&own, name));
        let to = name.as_deref().map(|name| join(above, name));
        match (name, to) {
            (Some(name), Some(to))
                if find(&self.tree, &to).is_none()
                    && find(&self.tree, &(self.canonical)(&to)).is_none()
                    && rename(&mut self.tree, key, &name) =>
            {
                let from = key.to_owned();
                self.changes.push(Change::Renamed { from, to });
                true
            }
            _ => self.remove(key),
        }
    }

    /// Puts another name in the place of a wrong one: the value itself, or the only key of a section.
    fn rename_value(&mut self, key: &str, name: &str, is_misspelt: bool) -> bool {
        if is_misspelt {
            self.guessed.insert(key.to_owned());
        } else {
            self.made.insert(key.to_owned());
            self.doubt_section(key);
        }
        let only = match find(&self.tree, key) {
            Some(Value::Object(section)) => section.keys().next().cloned(),
            _ => None,
        };
        let Some(old) = only else {
            self.made.insert(key.to_owned());
            return put(&mut self.tree, key, name.into());
        };
        let (from, to) = (join(key, &old), join(key, name));
        self.changes.push(Change::Renamed {
            from: from.clone(),
            to,
        });
        rename(&mut self.tree, &from, name)
    }

    fn remove(&mut self, key: &str) -> bool {
        if key.is_empty() || take(&mut self.tree, key).is_none() {
            return false;
        }
        let item = key.rsplit_once('.').unwrap_or(("", key));
        let above = find(&self.tree, item.0);
        match (above.is_some_and(Value::is_array), item.1.parse()) {
            (true, Ok(index)) => {
                let list = item.0.to_owned();
                self.shift_made(&list, index);
                self.made.insert(format!("{list}.{GONE}"));
                self.changes.push(Change::Removed { list, index });
            }
            _ => self.note_made(key),
        }
        true
    }

    /// Takes out the nearest section about `key` that is there.
    fn remove_section(&mut self, key: &str) -> bool {
        let sections: Vec<String> = parents(key).map(str::to_owned).collect();
        sections.iter().any(|section| self.remove(section))
    }

    /// The values that nobody wrote have other keys once item `index` of a list is gone.
    fn shift_made(&mut self, list: &str, index: usize) {
        let gone = format!("{list}.{index}");
        for keys in [&mut self.made, &mut self.guessed] {
            let stay = std::mem::take(keys).into_iter();
            let stay = stay.filter(|key| !is_within(key, &gone));
            *keys = stay
                .map(|key| earlier(&key, list, index).unwrap_or(key))
                .collect();
        }
        self.tries
            .retain(|key, _| key == list || !is_within(key, list));
    }
}

/// The section of a key whose last part, which may have dots in it, is `own`.
fn above<'k>(key: &'k str, own: &str) -> &'k str {
    let above = key.strip_suffix(own).unwrap_or_default();
    above.trim_end_matches('.')
}

/// A key with `name` in the place of the part that it was probably meant to be: of a path such as
/// `joints.big_ned.clearance` one part, of another key the whole.
fn corrected(key: &str, name: &str) -> String {
    let mut is_open = true;
    let part = |part: &str| {
        let is_meant = is_open && part != name && similar(part, [name]).is_some();
        is_open &= !is_meant;
        if is_meant {
            name.to_owned()
        } else {
            part.to_owned()
        }
    };
    match key.contains('.') {
        true => key.split('.').map(part).collect::<Vec<_>>().join("."),
        false => name.to_owned(),
    }
}

/// Whether `key`, in which `*` is any part, is `made` or stands below it.
fn fits_within(key: &str, made: &str) -> bool {
    let mut parts = key.split('.');
    let fits = |made: &str| parts.next().is_some_and(|part| part == "*" || part == made);
    made.is_empty() || made.split('.').all(fits)
}

/// The place of `key` below `place`; a key of the tree may have dots in it.
fn walk<'a>(place: Node<'a>, tree: Option<&Value>, key: &str) -> Option<Node<'a>> {
    if key.is_empty() {
        return Some(place);
    }
    let own = tree
        .and_then(Value::as_object)
        .and_then(|section| first(section, key));
    let (name, rest) = own.unwrap_or_else(|| key.split_once('.').unwrap_or((key, "")));
    let item = name.parse::<usize>().ok().and_then(|_| place.items());
    let below = tree.and_then(|tree| find(tree, name));
    walk(item.or_else(|| place.key(name))?, below, rest)
}

/// The key before item `index` of `list` was taken out.
fn later(key: &str, list: &str, index: usize) -> Option<String> {
    shifted(key, list, |i| if i >= index { i + 1 } else { i })
}

/// The key after item `index` of `list` was taken out.
fn earlier(key: &str, list: &str, index: usize) -> Option<String> {
    shifted(key, list, |i| if i > index { i - 1 } else { i })
}

fn shifted(key: &str, list: &str, to: impl Fn(usize) -> usize) -> Option<String> {
    let below = key.strip_prefix(list)?.strip_prefix('.')?;
    let (item, rest) = match below.split_once('.') {
        Some((item, rest)) => (item, Some(rest)),
        None => (below, None),
    };
    let item = to(item.parse().ok()?);
    Some(match rest {
        Some(rest) => format!("{list}.{item}.{rest}"),
        None => format!("{list}.{item}"),
    })
}
