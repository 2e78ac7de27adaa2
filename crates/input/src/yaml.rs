//! YAML text becomes a tree that remembers where each key and value stands.

use crate::error::{Error, Place, Problem, join};
use crate::tree::{find, parents};
use crate::{mistakes, reader, schema, yaml_repair};
use schemars::JsonSchema;
use serde::de::{self, Deserialize, DeserializeOwned, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};
use serde_saphyr::{
    DuplicateKeyPolicy, MessageFormatter, NonFiniteFloatPolicy, Spanned, UserMessageFormatter,
};
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// A file's content: its tree, and where things stand in it.
#[derive(Clone, Debug)]
pub struct Document {
    /// The content.
    pub tree: Value,
    file: Option<String>,
    places: BTreeMap<String, Places>,
    /// Mistakes of the text itself, with their places: lines that are not YAML, of which the tree has what was
    /// probably meant, and keys that stand a second time in their section, of which it has the first.
    faults: Vec<Error>,
    /// Whether lines were passed over: a key that is missing may have stood there.
    has_lost_lines: bool,
}

/// Where a key and its value stand.
#[derive(Clone, Copy, Debug)]
struct Places {
    key: Place,
    value: Place,
}

/// Reads `text` as a `T`; messages call the file `file_name`.
///
/// Sections become structs (with `deny_unknown_fields`), enums with the serde name `tag:law` are
/// sections whose key `law` names the variant.
///
/// # Errors
/// All mistakes, with their lines.
pub fn from_str<T: DeserializeOwned + JsonSchema>(text: &str, file_name: &str) -> Result<T, Error> {
    Document::parse(text, file_name)?.read()
}

/// Writes a tree as YAML; reading it gives the same tree.
///
/// # Errors
/// Where the tree has a form that YAML cannot hold.
pub fn to_string(tree: &Value) -> Result<String, Error> {
    serde_saphyr::to_string(tree).map_err(|e| Error::new("", Problem::Other(e.to_string())))
}

/// The text of a file with this content.
fn text(content: Vec<u8>) -> Result<String, Error> {
    String::from_utf8(content).map_err(|error| {
        let before = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let byte = error.as_bytes()[before.len()];
        let lines = before.split(|b| *b == b'\n');
        let last = lines.clone().next_back().unwrap_or_default();
        let place = Place {
            line: lines.count() as u64,
            column: String::from_utf8_lossy(last).chars().count() as u64 + 1,
        };
        let is_utf_16 = [[0xff, 0xfe], [0xfe, 0xff]]
            .iter()
            .any(|mark| error.as_bytes().starts_with(mark));
        let reason = match is_utf_16 {
            true => "it is text in UTF-16: save it as UTF-8".to_owned(),
            false => {
                format!("it is not text in UTF-8 from the byte {byte:#04x} on: save it as UTF-8")
            }
        };
        Error::new("", Problem::Other(reason)).at(place)
    })
}

impl Document {
    /// The content of the file at `path`.
    ///
    /// # Errors
    /// Where the file cannot be read or is not YAML.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let name = path.display().to_string();
        let content = files::open(path).and_then(|file| files::content(file, files::LONGEST_TEXT));
        let content = content.map_err(|error| {
            Error::new("", Problem::Unreadable(error.to_string())).in_file(&name)
        })?;
        let text = text(content).map_err(|error| error.in_file(&name))?;
        Self::parse(&text, &name)
    }

    /// The content `text` of a file that messages call `file_name`.
    ///
    /// # Errors
    /// Where the text is empty, or is not YAML and cannot be taken for it line by line. Lines that are not, and keys
    /// that a section has twice, are found when the content is read.
    pub fn parse(text: &str, file_name: &str) -> Result<Self, Error> {
        let read = yaml_repair::parse(text, &nodes).map_err(|error| error.in_file(file_name))?;
        let mut index = Index::default();
        let tree = match read.content {
            None => Value::Null,
            Some(node) => node.value.into_tree("", &mut index),
        };
        let mut faults = read.mistakes;
        if tree.is_null() {
            // Nothing is left of a text of which no line can be read.
            let empty = || Error::new("", Problem::Empty);
            let error = faults.into_iter().next().unwrap_or_else(empty);
            return Err(error.in_file(file_name));
        }
        faults.extend(index.duplicates);
        Ok(Self {
            tree,
            file: Some(file_name.to_owned()),
            places: index.places,
            faults,
            has_lost_lines: read.has_lost_lines,
        })
    }

    /// A document that was put together in memory: its messages have no lines.
    pub fn from_tree(tree: Value) -> Self {
        Self {
            tree,
            file: None,
            places: BTreeMap::new(),
            faults: Vec::new(),
            has_lost_lines: false,
        }
    }

    /// Reads the content as a `T`.
    ///
    /// # Errors
    /// All mistakes, with their lines.
    pub fn read<T: DeserializeOwned + JsonSchema>(&self) -> Result<T, Error> {
        self.collect(schema::generate::<T>, |tree| reader::read(tree))
    }

    /// What `read` makes of the content. Its errors have keys of the tree that it is given: this one, or one from
    /// which mistakes have been taken out, so that the next ones are found. `schema` says what belongs where. Only
    /// content that a person wrote is read more than once.
    ///
    /// # Errors
    /// All mistakes, with their lines and in their order.
    pub fn collect<T>(
        &self,
        schema: impl FnOnce() -> Value,
        read: impl FnMut(&Value) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.collect_named(schema, &str::to_owned, read)
    }

    /// As [`Document::collect`], where `canonical` gives the name that the schema has for a key.
    pub(crate) fn collect_named<T>(
        &self,
        schema: impl FnOnce() -> Value,
        canonical: &dyn Fn(&str) -> String,
        mut read: impl FnMut(&Value) -> Result<T, Error>,
    ) -> Result<T, Error> {
        match read(&self.tree) {
            Ok(content) if self.faults.is_empty() => Ok(content),
            Err(error) if self.file.is_none() => Err(self.locate(error)),
            _ => {
                let mut read = |tree: &Value| read(tree).map(|_| ());
                let (error, _) = self.mistakes(&schema(), canonical, &mut read);
                Err(error)
            }
        }
    }

    /// All mistakes that `read` finds, and the content without them, as far as they can be taken out.
    pub(crate) fn mistakes(
        &self,
        schema: &Value,
        canonical: &dyn Fn(&str) -> String,
        read: &mut dyn FnMut(&Value) -> Result<(), Error>,
    ) -> (Error, Value) {
        let (found, tree) = mistakes::all(&self.tree, schema, canonical, read);
        let is_lost = |error: &Error| {
            let is_missing = matches!(error.problem(), Problem::Missing { .. });
            self.has_lost_lines && is_missing && error.file().is_none()
        };
        let found = found.into_iter().filter(|error| !is_lost(error));
        let expected = |key: &str| schema::expected(schema, &canonical(key));
        let found = found.map(|error| {
            let key = error.key().to_owned();
            error.expecting(|| expected(&key))
        });
        let all = self.faults.iter().cloned().chain(found);
        let mut located: Vec<Error> = all.map(|error| self.locate(error)).collect();
        let here = |error: &Error| error.file() == self.file.as_deref();
        // What another file has wrong comes after what this one has.
        located.sort_by_key(|error| (!here(error), error.place().filter(|_| here(error))));
        let none = || Error::new("", Problem::Other("no mistake".to_owned()));
        (Error::all(located).unwrap_or_else(none), tree)
    }

    /// The same file with the content `tree`: messages have the lines of what stands in both.
    #[must_use]
    pub fn with_tree(&self, tree: Value) -> Self {
        Self {
            tree,
            ..self.clone()
        }
    }

    /// Mistakes of the text itself.
    pub(crate) fn faults(&self) -> &[Error] {
        &self.faults
    }

    /// Where the key at a dotted path stands.
    pub fn place_of(&self, key: &str) -> Option<Place> {
        self.places.get(key).map(|places| places.key)
    }

    /// `error` with the value as it is written, the file's name, and the place of its key or of the
    /// section that lacks it. A message quotes what stands at a key; of a file without keys, which is none of ours, it
    /// says what it is and not what stands in it.
    pub fn locate(&self, error: Error) -> Error {
        let each = error.into_each().into_iter().map(|e| self.locate_one(e));
        Error::all(each).unwrap_or_else(|| Error::new("", Problem::Empty))
    }

    fn locate_one(&self, error: Error) -> Error {
        if error.file().is_some() {
            return error;
        }
        let error = match error.key().is_empty() {
            true => error.unquoted(&self.tree),
            false => error,
        };
        let error = match find(&self.tree, error.key()) {
            Some(value) => error.written(value),
            None => error,
        };
        let Some(file) = &self.file else {
            return error;
        };
        let found = |key: &str| self.places.get(key);
        let place = match (found(error.key()), error.problem()) {
            (Some(at), Problem::UnknownKey { .. } | Problem::Duplicate) => Some(at.key),
            (Some(at), _) => Some(at.value),
            (None, _) => parents(error.key()).find_map(|key| found(key).map(|at| at.key)),
        };
        let place = place.unwrap_or(Place { line: 1, column: 1 });
        error.in_file(file).at(place)
    }
}

/// The nodes of a YAML text; none of an empty one.
fn nodes(text: &str) -> Result<Option<Spanned<Node>>, Error> {
    let options = serde_saphyr::options! {
        // Deep enough for any file of ours, and no test of the stack.
        budget: serde_saphyr::budget! { max_depth: 20 },
        strict_booleans: true,
        with_snippet: false,
        reject_unsupported_tags: true,
        // Both are reported with their dotted path, which only the tree knows.
        duplicate_keys: DuplicateKeyPolicy::PassThrough,
        non_finite_float_policy: NonFiniteFloatPolicy::AsString,
    };
    serde_saphyr::from_str_with_options(text, options).map_err(|error| syntax(&error))
}

fn syntax(error: &serde_saphyr::Error) -> Error {
    use serde_saphyr::Error as Yaml;
    let error = match error.without_snippet() {
        Yaml::AliasError { error, .. } => error,
        error => error,
    };
    let message = match error {
        Yaml::Budget { .. } => yaml_repair::TOO_LARGE.to_owned(),
        other => UserMessageFormatter.format_message(other).into_owned(),
    };
    let mine = Error::new("", Problem::Syntax(message));
    match error.location() {
        Some(location) => mine.at(place(&location)),
        None => mine,
    }
}

fn place(location: &serde_saphyr::Location) -> Place {
    Place {
        line: location.line(),
        column: location.column(),
    }
}

/// A node of the YAML text.
enum Node {
    Scalar(Value),
    List(Vec<Spanned<Node>>),
    Section(Vec<(Spanned<String>, Spanned<Node>)>),
}

/// Where keys and values stand.
#[derive(Default)]
struct Index {
    places: BTreeMap<String, Places>,
    duplicates: Vec<Error>,
}

impl Node {
    /// The node without places; those go to `index` under their dotted paths.
    fn into_tree(self, path: &str, index: &mut Index) -> Value {
        match self {
            Self::Scalar(value) => value,
            Self::List(items) => {
                let items = items.into_iter().enumerate();
                let item = |(i, item): (usize, Spanned<Self>)| {
                    let below = join(path, &i.to_string());
                    let at = place(&item.referenced);
                    index
                        .places
                        .insert(below.clone(), Places { key: at, value: at });
                    item.value.into_tree(&below, index)
                };
                items.map(item).collect()
            }
            Self::Section(entries) => {
                let mut section: Map<String, Value> = Map::new();
                for (key, node) in entries {
                    if let Some(whole) = cut_by_comma(&section, &key.value, &node.value) {
                        section.extend([whole]);
                        continue;
                    }
                    let below = join(path, &key.value);
                    let places = Places {
                        key: place(&key.referenced),
                        value: place(&node.referenced),
                    };
                    if index.places.contains_key(&below) {
                        let again = Error::new(below, Problem::Duplicate).at(places.key);
                        index.duplicates.push(again);
                        continue;
                    }
                    index.places.insert(below.clone(), places);
                    section.insert(key.value, node.value.into_tree(&below, index));
                }
                Value::Object(section)
            }
        }
    }
}

/// A number that its decimal comma has cut in two, whose end stands as a key without a value: the last entry of
/// `section` as it was meant. No key of ours begins with a digit.
fn cut_by_comma(section: &Map<String, Value>, key: &str, node: &Node) -> Option<(String, Value)> {
    let (last, number) = section.iter().next_back()?;
    let is_end =
        matches!(node, Node::Scalar(Value::Null)) && key.starts_with(|c: char| c.is_ascii_digit());
    let is_whole = number.is_i64() || number.is_u64();
    (is_end && is_whole).then(|| (last.clone(), format!("{number},{key}").into()))
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl<'de> Visitor<'de> for Any {
            type Value = Node;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a value, a list or a section")
            }
            fn visit_unit<E>(self) -> Result<Node, E> {
                Ok(Node::Scalar(Value::Null))
            }
            fn visit_none<E: de::Error>(self) -> Result<Node, E> {
                self.visit_unit()
            }
            fn visit_some<D: Deserializer<'de>>(self, inner: D) -> Result<Node, D::Error> {
                Node::deserialize(inner)
            }
            fn visit_bool<E>(self, value: bool) -> Result<Node, E> {
                Ok(Node::Scalar(Value::Bool(value)))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Node, E> {
                Ok(Node::Scalar(value.into()))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Node, E> {
                Ok(Node::Scalar(value.into()))
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Node, E> {
                let number =
                    Number::from_f64(value).ok_or_else(|| E::custom("numbers must be finite"))?;
                Ok(Node::Scalar(Value::Number(number)))
            }
            fn visit_str<E>(self, text: &str) -> Result<Node, E> {
                Ok(Node::Scalar(text.into()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Node, A::Error> {
                let mut items = Vec::new();
                while let Some(item) = list.next_element()? {
                    items.push(item);
                }
                Ok(Node::List(items))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut section: A) -> Result<Node, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = section.next_entry()? {
                    entries.push(entry);
                }
                Ok(Node::Section(entries))
            }
        }
        deserializer.deserialize_any(Any)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// The content of a text, and the lines of its mistakes.
    fn read(text: &str) -> (Value, Vec<u64>) {
        let document = Document::parse(text, "f.yaml").unwrap();
        let lines = document.faults().iter().filter_map(Error::place);
        (
            document.tree.clone(),
            lines.map(|place| place.line).collect(),
        )
    }

    #[test]
    fn what_was_meant_is_read() {
        for (text, tree, lines) in [
            (
                "a:\n\tb: 1\n\tc: 2\n",
                json!({"a": {"b": 1, "c": 2}}),
                vec![2],
            ),
            (
                "a: 1\nspeed:740 rpm\nb: 2\n",
                json!({"a": 1, "speed": "740 rpm", "b": 2}),
                vec![2],
            ),
            (
                "a: 1\nspeed = 740 rpm\n",
                json!({"a": 1, "speed": "740 rpm"}),
                vec![2],
            ),
            (
                "a: {b: [1, 2\nc: 3\n",
                json!({"a": {"b": [1, 2]}, "c": 3}),
                vec![1],
            ),
            (
                "a:\n  b: 1\n   c: 2\n  d: 3\n",
                json!({"a": {"b": 1, "c": 2, "d": 3}}),
                vec![3],
            ),
            ("a: 1\n? ] {\nb: 2\n", json!({"a": 1, "b": 2}), vec![2]),
        ] {
            assert_eq!(read(text), (tree, lines), "{text}");
        }
    }

    #[test]
    fn what_no_repair_helps_is_refused() {
        let error = Document::parse(&"[".repeat(1000), "f.yaml").unwrap_err();
        assert!(matches!(error.problem(), Problem::Syntax(_)), "{error}");
    }
}
