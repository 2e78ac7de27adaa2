//! A place in a schema: what may stand there.

use serde_json::{Map, Value, json};

/// A place in a schema: the alternatives that may stand there, references followed.
pub(crate) struct Node<'a> {
    root: &'a Value,
    alternatives: Vec<&'a Value>,
}

impl<'a> Node<'a> {
    /// The top of what the schema `root` describes.
    pub(crate) fn top(root: &'a Value) -> Self {
        Self::expand(root, [root])
    }

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

    /// Whether `key` is one of the keys that may stand here.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.sections().any(|section| section.contains_key(key))
    }

    /// What may stand at `key`.
    pub(crate) fn key(&self, key: &str) -> Option<Self> {
        let mut schemas: Vec<&Value> = self.sections().filter_map(|s| s.get(key)).collect();
        if schemas.is_empty() {
            // Keys that people choose, such as paths.
            let free = self.alternatives.iter();
            schemas = free
                .filter_map(|s| s.get("additionalProperties").filter(|s| s.is_object()))
                .collect();
        }
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

    /// What may stand at a dotted path; here at the empty one.
    pub(crate) fn walk_or_top(self, path: &str) -> Option<Self> {
        if path.is_empty() {
            Some(self)
        } else {
            self.walk(path)
        }
    }

    /// What the key `key` means.
    pub(crate) fn words(&self, key: &str) -> Option<String> {
        let mut words = self
            .sections()
            .filter_map(|s| s.get(key)?["description"].as_str());
        words.next().map(str::to_owned)
    }

    /// A usual value of the key `key`: its own example, or else that of its kind.
    pub(crate) fn usual(&self, key: &str) -> Option<Value> {
        let mut own = self
            .sections()
            .filter_map(|s| s.get(key)?["examples"].get(0));
        let of_kind = || self.key(key)?.example().map(Value::from);
        own.next().cloned().or_else(of_kind)
    }

    /// Whether all sections that may stand here have the same keys.
    pub(crate) fn is_of_one_kind(&self) -> bool {
        self.sections().count() == 1
    }

    /// A text or a number that may stand here, as the schema has it for an example.
    pub(crate) fn example(&self) -> Option<String> {
        let examples = self
            .alternatives
            .iter()
            .filter_map(|s| s["examples"][0].as_str());
        examples.map(str::to_owned).next()
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
            _ => match self.example() {
                Some(example) => format!("text, e.g. '{example}'"),
                None => "text".to_owned(),
            },
        })
    }

    /// Whether what stands here names the kind of its section.
    pub(crate) fn is_tag(&self) -> bool {
        let mut alternatives = self.alternatives.iter();
        alternatives.len() > 1
            && alternatives.all(|schema| schema.get("const").is_some_and(Value::is_string))
    }

    /// Values that may stand here as far as the schema says, the likeliest first: examples, and their multiples,
    /// which may get along better with the rest of a file.
    pub(crate) fn values(&self) -> Vec<Value> {
        let each = self.alternatives.iter().map(|schema| values(schema));
        each.collect::<Vec<_>>().concat()
    }

    fn sections(&self) -> impl Iterator<Item = &'a Map<String, Value>> + '_ {
        self.alternatives
            .iter()
            .filter_map(|schema| schema["properties"].as_object())
    }
}

/// Values that may stand where `schema` holds.
fn values(schema: &Value) -> Vec<Value> {
    if let Some(only) = schema.get("const") {
        return vec![only.clone()];
    }
    if let Some(names) = schema["enum"].as_array() {
        return names.clone();
    }
    if let Some(examples) = schema["examples"].as_array() {
        let values = examples.iter().flat_map(|example| match example {
            Value::String(text) => multiples(text),
            other => vec![other.clone()],
        });
        return values.collect();
    }
    match schema["type"].as_str() {
        Some("object") => vec![json!({})],
        Some("array") => {
            let least = schema["minItems"].as_u64().unwrap_or(0).min(9);
            vec![json!([]), Value::Array(vec![Value::Null; least as usize])]
        }
        Some("number") => [1.0, 0.5, 0.1, 2.0, 10.0].map(Value::from).into(),
        Some("integer") => {
            let least = schema["minimum"].as_u64().unwrap_or(0);
            let most = schema["maximum"].as_u64().unwrap_or(u64::MAX);
            let whole = [least, 1, 2, 4, 16, 100];
            let whole = whole.into_iter().filter(|n| (least..=most).contains(n));
            whole.map(Value::from).collect()
        }
        Some("boolean") => vec![json!(false), json!(true)],
        Some("string") => vec![json!("x"), json!("x1")],
        _ => Vec::new(),
    }
}

/// A quantity, and powers of ten of it.
fn multiples(example: &str) -> Vec<Value> {
    let Some((number, unit)) = example.split_once(' ') else {
        return vec![example.into()];
    };
    let times = |power: i32| format!("{number}e{power} {unit}").into();
    let text = |power| match (power, number.contains('e')) {
        (0, _) | (_, true) => example.into(),
        (power, false) => times(power),
    };
    [0, 3, -3, 6, -6].map(text).into()
}
