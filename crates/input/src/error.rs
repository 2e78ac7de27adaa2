//! One message per mistake: where it is, which key, what was found, what was expected.

pub use crate::nearest::nearest;
use crate::nearest::slipped;

use serde::de::Unexpected;
use serde_json::Value;
use std::fmt;

/// A mistake in a file that a person wrote.
///
/// Shown on one line: `file:line:column: key: problem`. What is not known is left out: a tree
/// that was built in memory has no lines, a syntax error has no key. Where a file has several mistakes, the first
/// carries the others, and each is shown on a line of its own, in the order of the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.lines())]
pub struct Error {
    file: Option<String>,
    place: Option<Place>,
    key: String,
    problem: Box<Problem>,
    company: Box<Company>,
}

/// What comes with a mistake.
#[derive(Clone, Debug, Default, PartialEq)]
struct Company {
    /// Keys of the values that the wrong one was held against, where there are some.
    against: Vec<String>,
    /// Further mistakes.
    others: Vec<Error>,
}

/// Begins a key from the top of the file.
const FROM_TOP: char = '/';

/// Line and column in a file, both counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Line.
    pub line: u64,
    /// Column, in characters.
    pub column: u64,
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// A value of the wrong kind, dimension or size.
    #[error("found {found}, expected {expected}")]
    Found {
        /// The value as it stands in the file.
        found: String,
        /// What belongs there, with an example.
        expected: String,
    },
    /// A key that does not exist.
    #[error("unknown key; {}", .belongs.clone().unwrap_or_else(|| format!("expected {}", choices(.known, .nearest))))]
    UnknownKey {
        /// The keys that do exist there.
        known: Vec<String>,
        /// The one that was probably meant.
        nearest: Option<String>,
        /// Where it, or what stands in it, belongs, if that is elsewhere.
        belongs: Option<String>,
    },
    /// A name that is not in the list that the place allows.
    #[error("found {}, expected {}", quoted(.found), choices(.known, .nearest))]
    UnknownName {
        /// The name as it stands in the file.
        found: String,
        /// The names that can stand there.
        known: Vec<String>,
        /// The one that was probably meant.
        nearest: Option<String>,
    },
    /// A key that must be there and is not.
    #[error("missing{}", .expected.as_ref().map_or(String::new(), |e| format!("; expected {e}")))]
    Missing {
        /// What belongs there, where it is known.
        expected: Option<String>,
    },
    /// A key that stands twice in one section.
    #[error("the key stands here a second time")]
    Duplicate,
    /// Text that is not YAML.
    #[error("not valid YAML: {0}")]
    Syntax(String),
    /// A file without content.
    #[error("the file is empty")]
    Empty,
    /// A file that cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// Anything else.
    #[error("{0}")]
    Other(String),
}

impl Error {
    /// `problem` at the dotted path `key` (empty for the whole file).
    pub fn new(key: impl Into<String>, problem: Problem) -> Self {
        Self {
            file: None,
            place: None,
            key: key.into(),
            problem: Box::new(problem),
            company: Box::default(),
        }
    }

    /// All of `mistakes` in one; none where there is none.
    pub fn all(mistakes: impl IntoIterator<Item = Self>) -> Option<Self> {
        let mut each = mistakes.into_iter().flat_map(Self::into_each);
        let mut first = each.next()?;
        first.company.others = each.collect();
        Some(first)
    }

    /// This mistake, and those of `other`.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        self.company.others.extend(other.into_each());
        self
    }

    /// Each mistake by itself.
    pub fn into_each(mut self) -> Vec<Self> {
        let others = std::mem::take(&mut self.company.others);
        std::iter::once(self).chain(others).collect()
    }

    /// The same mistake, which holds only as long as the value at `key` stays: it was held against that. The key is
    /// one of the same section, or begins with `/` and is one of the file; a part may be `*`.
    #[must_use]
    pub fn against(mut self, key: impl Into<String>) -> Self {
        self.company.against.push(key.into());
        self
    }

    /// The keys of the values that it was held against, from the top of the file.
    pub(crate) fn partners(&self) -> impl Iterator<Item = &str> {
        self.company
            .against
            .iter()
            .map(|key| key.trim_start_matches(FROM_TOP))
    }

    /// The same mistake in a file that has other names for its keys.
    #[must_use]
    pub(crate) fn renamed(mut self, name: &dyn Fn(&str) -> String) -> Self {
        self.key = name(&self.key);
        for key in &mut self.company.against {
            *key = name(key.trim_start_matches(FROM_TOP));
        }
        let others = std::mem::take(&mut self.company.others).into_iter();
        self.company.others = others.map(|e| e.renamed(name)).collect();
        self
    }

    /// `found` stands at `key` where `expected` belongs.
    pub fn unexpected(
        key: impl Into<String>,
        found: impl fmt::Display,
        expected: impl fmt::Display,
    ) -> Self {
        Self::new(
            key,
            Problem::Found {
                found: found.to_string(),
                expected: expected.to_string(),
            },
        )
    }

    /// The name `found` stands at `key` where one of `known` belongs.
    pub fn unknown_name(key: impl Into<String>, found: &str, known: &[&str]) -> Self {
        Self::new(
            key,
            Problem::UnknownName {
                found: found.to_owned(),
                nearest: nearest(found, known.iter().copied()).map(str::to_owned),
                known: owned(known),
            },
        )
    }

    /// The key `name` stands in a section that has only the keys `known`.
    pub fn unknown_key(name: &str, known: &[&str]) -> Self {
        Self::new(
            name,
            Problem::UnknownKey {
                nearest: nearest(name, known.iter().copied()).map(str::to_owned),
                known: owned(known),
                belongs: None,
            },
        )
    }

    /// What stands at `key` does not go together with the rest of the file;
    /// [`Document::locate`](crate::yaml::Document::locate) fills in what it is, as it is written.
    pub fn clash(key: impl Into<String>, expected: impl fmt::Display) -> Self {
        Self::unexpected(key, "", expected)
    }

    /// The key `name` must be there and is not.
    pub fn missing(name: impl Into<String>) -> Self {
        Self::new(name, Problem::Missing { expected: None })
    }

    /// The same mistake seen from one level up, where its section is called `key`.
    #[must_use]
    pub fn under(mut self, key: impl fmt::Display) -> Self {
        let key = key.to_string();
        self.key = join(&key, &self.key);
        for name in self
            .company
            .against
            .iter_mut()
            .filter(|name| !name.starts_with(FROM_TOP))
        {
            *name = join(&key, name);
        }
        let others = std::mem::take(&mut self.company.others).into_iter();
        self.company.others = others.map(|e| e.under(&key)).collect();
        self
    }

    /// The same mistake in `file`.
    #[must_use]
    pub fn in_file(mut self, file: &str) -> Self {
        self.file.get_or_insert_with(|| file.to_owned());
        self
    }

    /// The file, where it is known.
    pub fn file(&self) -> Option<&str> {
        self.file.as_deref()
    }

    /// The same mistake at `place`, unless its place is known already.
    #[must_use]
    pub fn at(mut self, place: Place) -> Self {
        self.place.get_or_insert(place);
        self
    }

    /// The dotted path of the key; empty for the whole file.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Line and column, where there is a file.
    pub fn place(&self) -> Option<Place> {
        self.place
    }

    /// What is wrong.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    pub(crate) fn with_key(mut self, key: String) -> Self {
        self.key = key;
        self
    }

    /// Fills in what stands in the file, if that is still open.
    pub(crate) fn written(mut self, value: &Value) -> Self {
        if let Problem::Found { found, .. } = &mut *self.problem
            && found.is_empty()
        {
            *found = shown(value);
        }
        self
    }

    /// Shows a value as the file has it: `own` gives, for a key, what messages show of the value that was read and of the
    /// one in the file.
    #[must_use]
    pub(crate) fn showing(mut self, own: &dyn Fn(&str) -> Option<(String, String)>) -> Self {
        if let Problem::Found { found, .. } = &mut *self.problem
            && let Some((_, own)) = own(&self.key).filter(|(read, _)| read == found)
        {
            *found = own;
        }
        let others = std::mem::take(&mut self.company.others).into_iter();
        self.company.others = others.map(|e| e.showing(own)).collect();
        self
    }

    /// Says what `value` is in the place of what it holds.
    pub(crate) fn unquoted(mut self, value: &Value) -> Self {
        if let Problem::Found { found, .. } = &mut *self.problem {
            *found = match value {
                Value::String(_) => "text".to_owned(),
                other => shown(other),
            };
        }
        self
    }

    /// Looks among `others` for what an unknown key was meant to be, where none of the known keys is near.
    pub(crate) fn suggesting<'a>(mut self, others: impl Iterator<Item = &'a str>) -> Self {
        let name = self.key.rsplit('.').next().unwrap_or_default();
        let others: Vec<&str> = others.collect();
        let near = slipped(name, &others).map(str::to_owned);
        if let Problem::UnknownKey { nearest, .. } = &mut *self.problem
            && nearest.is_none()
        {
            *nearest = near;
        }
        self
    }

    /// Says which of the known names an unknown one stands for: `known_as` gives it.
    pub(crate) fn meaning(mut self, known_as: &dyn Fn(&str) -> Option<&'static str>) -> Self {
        if let Problem::UnknownName {
            found,
            known,
            nearest,
        } = &mut *self.problem
            && let Some(name) = known_as(found)
            && known.iter().any(|known| known == name)
        {
            *nearest = Some(name.to_owned());
        }
        self
    }

    /// Says where an unknown key belongs.
    pub(crate) fn belonging(mut self, words: &str) -> Self {
        if let Problem::UnknownKey { belongs, .. } = &mut *self.problem {
            *belongs = Some(words.to_owned());
        }
        self
    }

    /// Says of an unknown key that nothing stands for it here; none of the known keys was meant.
    pub(crate) fn not_modelled(mut self, words: &str) -> Self {
        if let Problem::UnknownKey { nearest, .. } = &mut *self.problem {
            *nearest = None;
        }
        self.belonging(words)
    }

    /// Fills in what belongs in the place of a missing key, if that is still open.
    pub(crate) fn expecting(mut self, expectation: impl FnOnce() -> Option<String>) -> Self {
        if let Problem::Missing { expected } = &mut *self.problem
            && expected.is_none()
        {
            *expected = expectation();
        }
        self
    }

    fn lines(&self) -> String {
        let each = std::iter::once(self).chain(&self.company.others);
        each.map(Self::line).collect::<Vec<_>>().join("\n")
    }

    fn line(&self) -> String {
        let mut line = self.file.clone().unwrap_or_default();
        if let (Some(_), Some(place)) = (&self.file, self.place) {
            line += &format!(":{}:{}", place.line, place.column);
        }
        for part in [self.key.clone(), self.problem.to_string()] {
            if !line.is_empty() && !part.is_empty() {
                line += ": ";
            }
            line += &part;
        }
        one_line(&line)
    }
}

/// `a.b` of `a` and `b`; either may be empty.
pub(crate) fn join(head: &str, tail: &str) -> String {
    match (head, tail) {
        (head, "") => head.to_owned(),
        ("", tail) => tail.to_owned(),
        (head, tail) => format!("{head}.{tail}"),
    }
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

fn choices(known: &[String], nearest: &Option<String>) -> String {
    let list = match known {
        [] => "nothing here".to_owned(),
        [only] => only.clone(),
        several => format!("one of {}", several.join(", ")),
    };
    match nearest {
        Some(name) => format!("{list}; did you mean '{name}'?"),
        None => list,
    }
}

impl serde::de::Error for Error {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::new("", Problem::Other(message.to_string()))
    }

    fn invalid_type(found: Unexpected, expected: &dyn serde::de::Expected) -> Self {
        Self::unexpected("", words(&found), expected)
    }

    fn invalid_value(found: Unexpected, expected: &dyn serde::de::Expected) -> Self {
        Self::unexpected("", words(&found), expected)
    }

    fn invalid_length(length: usize, expected: &dyn serde::de::Expected) -> Self {
        Self::unexpected("", format_args!("a list of {length}"), expected)
    }

    fn unknown_variant(found: &str, known: &'static [&'static str]) -> Self {
        Self::unknown_name("", found, known)
    }

    fn unknown_field(name: &str, known: &'static [&'static str]) -> Self {
        Self::unknown_key(name, known)
    }

    fn missing_field(name: &'static str) -> Self {
        Self::missing(name)
    }

    fn duplicate_field(name: &'static str) -> Self {
        Self::new(name, Problem::Duplicate)
    }
}

/// What was found, as its author would recognise it.
fn words(found: &Unexpected) -> String {
    use Unexpected::*;
    match found {
        Bool(value) => value.to_string(),
        Unsigned(value) => value.to_string(),
        Signed(value) => value.to_string(),
        Float(value) => value.to_string(),
        Str(text) => quoted(text),
        Unit | Option => "nothing".to_owned(),
        Seq => "a list".to_owned(),
        Map => "a section".to_owned(),
        other => other.to_string(),
    }
}

/// A value of the tree, as its author would recognise it.
pub(crate) fn shown(value: &Value) -> String {
    match value {
        Value::Array(items) if items.is_empty() => "an empty list".to_owned(),
        Value::Object(section) if section.is_empty() => "an empty section".to_owned(),
        value => words(&unexpected(value)),
    }
}

/// A value of the tree in serde's terms.
pub(crate) fn unexpected(value: &Value) -> Unexpected<'_> {
    match value {
        Value::Null => Unexpected::Unit,
        Value::Bool(value) => Unexpected::Bool(*value),
        Value::Number(number) => match (number.as_u64(), number.as_i64(), number.as_f64()) {
            (Some(value), _, _) => Unexpected::Unsigned(value),
            (_, Some(value), _) => Unexpected::Signed(value),
            (_, _, value) => Unexpected::Float(value.unwrap_or(f64::NAN)),
        },
        Value::String(text) => Unexpected::Str(text),
        Value::Array(_) => Unexpected::Seq,
        Value::Object(_) => Unexpected::Map,
    }
}

/// `text` in quotation marks, of bearable length.
pub(crate) fn quoted(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("'{}…'", &text[..end]),
        None => format!("'{text}'"),
    }
}

/// `text` with its line breaks and other control characters written out.
fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() {
            line.extend(c.escape_default());
        } else {
            line.push(c);
        }
    }
    line
}
