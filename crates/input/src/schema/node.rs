//! A place in the schema of the machine file: what may stand there.

use super::generate::generate;
use crate::machine_file::Sections;
use serde_json::{Map, Value};
use std::sync::LazyLock;

static MACHINE: LazyLock<Value> = LazyLock::new(generate::<Sections>);

/// A place in a schema: the alternatives that may stand there, references followed.
pub(crate) struct Node<'a> {
    root: &'a Value,
    alternatives: Vec<&'a Value>,
}

impl Node<'static> {
    /// The top of the machine file.
    pub(crate) fn machine() -> Self {
        Node::expand(&MACHINE, [&*MACHINE])
    }
}

impl<'a> Node<'a> {
    fn expand(root: &'a Value, schemas: impl IntoIterator<Item = &'a Value>) -> Self {
        let mut alternatives: Vec<&Value> = Vec::new();
        let mut open: Vec<&Value> = schemas.into_iter().collect();
        open.reverse();
        while let Some(schema) = open.pop() {
            let target = schema["$ref"].as_str().and_then(|r| r.strip_prefix('#'));
            open.extend(target.and_then(|target| root.pointer(target)));
            let branches = ["anyOf", "oneOf"].map(|k| schema[k].as_array());
            open.extend(branches.into_iter().flatten().flatten().rev());
            let says = schema.get("type").is_some() || schema.get("const").is_some();
            // Several alternatives may lead to one definition.
            if says && !alternatives.iter().any(|a| std::ptr::eq(*a, schema)) {
                alternatives.push(schema);
            }
        }
        Self { root, alternatives }
    }

    /// The keys that may stand here.
    pub(crate) fn keys(&self) -> Vec<&'a str> {
        let mut keys = Vec::new();
        for key in self.sections().flat_map(Map::keys) {
            if !keys.contains(&key.as_str()) {
                keys.push(key);
            }
        }
        keys
    }

    /// What may stand at `key`.
    pub(crate) fn key(&self, key: &str) -> Option<Self> {
        let schemas: Vec<&Value> = self.sections().filter_map(|s| s.get(key)).collect();
        (!schemas.is_empty()).then(|| Self::expand(self.root, schemas))
    }

    /// What may stand in the list that may stand here.
    pub(crate) fn items(&self) -> Option<Self> {
        let lists = self.alternatives.iter().filter_map(|s| s.get("items"));
        let schemas: Vec<&Value> = lists.collect();
        (!schemas.is_empty()).then(|| Self::expand(self.root, schemas))
    }

    /// What may stand at a dotted path of keys and indices.
    pub(crate) fn walk(self, path: &str) -> Option<Self> {
        path.split('.').try_fold(self, |node, part| {
            let index = part.parse::<usize>().is_ok();
            if index { node.items() } else { node.key(part) }
        })
    }

    /// What belongs here, in words; none where that depends on more than the place.
    pub(crate) fn expected(&self) -> Option<String> {
        let mut texts = self
            .alternatives
            .iter()
            .filter(|s| s.get("pattern").is_some());
        if let Some(text) = texts.next() {
            let only = texts.next().is_none();
            return text["description"]
                .as_str()
                .filter(|_| only)
                .map(str::to_owned);
        }
        let names = self.alternatives.iter().filter_map(|s| s["const"].as_str());
        let names: Vec<&str> = names.collect();
        if !names.is_empty() {
            return Some(format!("one of {}", names.join(", ")));
        }
        Some(match self.alternatives.first()?["type"].as_str()? {
            "object" => format!("a section with the keys {}", self.keys().join(", ")),
            "array" => "a list".to_owned(),
            "number" => "a plain number".to_owned(),
            "integer" => "a whole number".to_owned(),
            _ => "text".to_owned(),
        })
    }

    fn sections(&self) -> impl Iterator<Item = &'a Map<String, Value>> + '_ {
        self.alternatives
            .iter()
            .filter_map(|schema| schema["properties"].as_object())
    }
}
