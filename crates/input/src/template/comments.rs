//! A tree as YAML, each key with what its schema says of it.

use crate::error::{Error, join};
use crate::schema::Node;
use crate::yaml;
use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// Columns of a line of comment.
const WIDTH: usize = 100;

/// What is written.
pub struct Commented<'a> {
    /// The content.
    pub tree: &'a Value,
    /// The schema of the file.
    pub schema: &'a Value,
    /// What is said of the file, above it.
    pub head: &'a str,
    /// What is said of a key beside the words of its schema.
    pub note: &'a dyn Fn(&str) -> Option<String>,
    /// Which keys that the tree does not have are shown, commented out, by their path.
    pub optional: &'a dyn Fn(&str) -> bool,
}

/// The content as YAML with comments; reading it gives the same content. The same words are not said twice.
///
/// # Errors
/// Where the content has a form that YAML cannot hold.
pub fn commented(file: &Commented) -> Result<String, Error> {
    let mut writer = Writer {
        file,
        said: BTreeSet::new(),
    };
    let mut lines = Vec::new();
    for line in file.head.lines() {
        lines.push(comment(0, line));
    }
    if let Value::Object(section) = file.tree {
        writer.section(section, "", 0, &mut lines)?;
    }
    Ok(lines.join("\n") + "\n")
}

struct Writer<'a> {
    file: &'a Commented<'a>,
    /// What has been said already.
    said: BTreeSet<String>,
}

impl Writer<'_> {
    fn section(
        &mut self,
        section: &Map<String, Value>,
        path: &str,
        indent: usize,
        lines: &mut Vec<String>,
    ) -> Result<(), Error> {
        for (key, value) in section {
            let below = join(path, key);
            if indent == 0 {
                lines.push(String::new());
            }
            self.say(&below, path, key, indent, lines);
            self.entry(key, value, &below, indent, lines)?;
        }
        self.others(section, path, indent, lines)
    }

    fn entry(
        &mut self,
        key: &str,
        value: &Value,
        path: &str,
        indent: usize,
        lines: &mut Vec<String>,
    ) -> Result<(), Error> {
        let pad = " ".repeat(indent);
        let key = scalar(&key.into())?;
        match value {
            Value::Object(section) if !section.is_empty() => {
                lines.push(format!("{pad}{key}:"));
                self.section(section, path, indent + 2, lines)
            }
            Value::Array(items) if items.iter().any(Value::is_object) => {
                lines.push(format!("{pad}{key}:"));
                for (i, item) in items.iter().enumerate() {
                    self.item(item, &join(path, &i.to_string()), indent + 2, lines)?;
                }
                Ok(())
            }
            other => {
                lines.push(format!("{pad}{key}: {}", flow(other)?));
                Ok(())
            }
        }
    }

    /// An item of a list: its first key stands behind the dash.
    fn item(
        &mut self,
        item: &Value,
        path: &str,
        indent: usize,
        lines: &mut Vec<String>,
    ) -> Result<(), Error> {
        let pad = " ".repeat(indent);
        let Value::Object(section) = item else {
            lines.push(format!("{pad}- {}", flow(item)?));
            return Ok(());
        };
        let mut inside = Vec::new();
        self.section(section, path, indent + 2, &mut inside)?;
        let first = inside
            .iter()
            .position(|line| !line.trim_start().starts_with('#'));
        for (i, line) in inside.into_iter().enumerate() {
            lines.push(match first {
                Some(first) if i < first => format!("{pad}{}", line.trim_start()),
                Some(first) if i == first => format!("{pad}- {}", line.trim_start()),
                _ => line,
            });
        }
        Ok(())
    }

    /// What the schema says of the key, and what else is known of it.
    fn say(&mut self, below: &str, path: &str, key: &str, indent: usize, lines: &mut Vec<String>) {
        let place = Node::top(self.file.schema).walk_or_top(path);
        let words = place.and_then(|place| place.words(key));
        let note = (self.file.note)(below);
        for text in words.into_iter().chain(note) {
            if self.said.insert(text.clone()) {
                lines.push(comment(indent, &text));
            }
        }
    }

    /// The keys that the section may have and does not have.
    fn others(
        &mut self,
        section: &Map<String, Value>,
        path: &str,
        indent: usize,
        lines: &mut Vec<String>,
    ) -> Result<(), Error> {
        let Some(place) = Node::top(self.file.schema).walk_or_top(path) else {
            return Ok(());
        };
        let is_of_one_kind = place.is_of_one_kind();
        for key in place
            .keys()
            .into_iter()
            .filter(|key| !section.contains_key(*key) && (self.file.optional)(&join(path, key)))
        {
            let example = place.usual(key);
            let words = place.words(key);
            if let (true, Some(example), Some(words)) = (is_of_one_kind, example, words)
                && self.said.insert(words.clone())
            {
                if indent == 0 {
                    lines.push(String::new());
                }
                lines.push(comment(indent, &words));
                let example = flow(&example)?;
                lines.push(format!("{}# {key}: {example}", " ".repeat(indent)));
            }
        }
        Ok(())
    }
}

/// Lines of comment.
fn comment(indent: usize, text: &str) -> String {
    let start = format!("{}#", " ".repeat(indent));
    let mut lines = vec![start.clone()];
    for word in text.split_whitespace() {
        let last = lines.last_mut();
        let Some(line) = last.filter(|line| line.len() + word.len() < WIDTH) else {
            lines.push(format!("{start} {word}"));
            continue;
        };
        line.push(' ');
        line.push_str(word);
    }
    lines.join("\n")
}

/// A value on one line.
fn flow(value: &Value) -> Result<String, Error> {
    match value {
        Value::Array(items) => {
            let items: Result<Vec<String>, Error> = items.iter().map(flow).collect();
            Ok(format!("[{}]", items?.join(", ")))
        }
        Value::Object(section) => {
            let entry = |(key, value): (&String, &Value)| {
                Ok(format!(
                    "{}: {}",
                    scalar(&key.as_str().into())?,
                    flow(value)?
                ))
            };
            let entries: Result<Vec<String>, Error> = section.iter().map(entry).collect();
            Ok(format!("{{{}}}", entries?.join(", ")))
        }
        value => scalar(value),
    }
}

fn scalar(value: &Value) -> Result<String, Error> {
    let is_plain = |c: char| c.is_alphanumeric() || " ./_^%*²³°µ-".contains(c);
    match value {
        // Quotation marks keep what YAML would read otherwise; plain text needs none.
        Value::String(text)
            if text.chars().all(is_plain) && text.starts_with(char::is_alphanumeric) =>
        {
            Ok(yaml::to_string(value)?.trim_end().to_owned())
        }
        Value::String(_) => serde_json::to_string(value)
            .map_err(|e| Error::new("", crate::error::Problem::Other(e.to_string()))),
        value => Ok(yaml::to_string(value)?.trim_end().to_owned()),
    }
}
