//! What sets the operating points of a sweep apart.

use crate::words;
use serde_json::Value;
use sweep::reader::{Dataset, Meaning};

/// The values that are not the same at all operating points, in words.
pub(crate) struct Settings {
    /// What each is, and its value at each operating point.
    columns: Vec<(String, Vec<String>)>,
}

impl Settings {
    /// Of operating points of which each has one of the windows `points`. Values that go together, such
    /// as the damping of several joints, are one.
    pub(crate) fn new(dataset: &Dataset, points: &[usize]) -> Self {
        let numbers = dataset.windows.labels.iter();
        let numbers = numbers.filter(|label| label.joint().is_none());
        let mut columns: Vec<(Vec<String>, Vec<String>)> = numbers
            .map(|label| {
                let name = match &label.meaning {
                    Meaning::Parameter(path) => segments(path),
                    _ => vec![words::name(label)],
                };
                let shown = points.iter().map(|&window| words::value(label, window));
                (name, shown.collect())
            })
            .collect();
        for text in &dataset.windows.texts {
            let own: Vec<&str> = points.iter().map(|&w| text.values[w].as_str()).collect();
            columns.extend(parts(&segments(&text.path), &own));
        }
        columns.retain(|(_, values)| values.iter().any(|value| *value != values[0]));
        let mut together: Vec<(Vec<Vec<String>>, Vec<String>)> = Vec::new();
        for (name, values) in columns {
            match together.iter_mut().find(|(_, other)| *other == values) {
                Some((names, _)) => names.push(name),
                None => together.push((vec![name], values)),
            }
        }
        let columns = together.into_iter();
        Self {
            columns: columns
                .map(|(names, values)| (one_name(&names), values))
                .collect(),
        }
    }

    /// Name and value of each at operating point `at`.
    pub(crate) fn at(&self, at: usize) -> Vec<(String, String)> {
        let own = self.columns.iter();
        own.map(|(name, values)| (name.clone(), values[at].clone()))
            .collect()
    }

    /// The words about operating point `at`, with what they do not say yet.
    pub(crate) fn described(&self, words: &str, at: usize) -> String {
        let more = self
            .columns
            .iter()
            .filter(|(_, values)| !words.contains(&values[at]));
        let more = more.map(|(name, values)| format!("{name} {}", values[at]));
        let parts = std::iter::once(words.to_owned()).chain(more);
        parts.collect::<Vec<_>>().join(", ")
    }
}

/// The words of each part of a path, without the section of all joints: «big end», «contact»,
/// «damping».
fn segments(path: &str) -> Vec<String> {
    let parts = path
        .split('.')
        .filter(|part| *part != "joints" && *part != "throws");
    parts.map(text::words).collect()
}

/// The values of a parameter that is text; a section is taken apart into its keys.
fn parts(name: &[String], values: &[&str]) -> Vec<(Vec<String>, Vec<String>)> {
    let sections: Option<Vec<Value>> = values
        .iter()
        .map(|value| serde_json::from_str(value).ok().filter(Value::is_object))
        .collect();
    let Some(sections) = sections else {
        let plain = values.iter().map(|value| section_in_words(value)).collect();
        return vec![(name.to_vec(), plain)];
    };
    let mut keys: Vec<&String> = Vec::new();
    for key in sections
        .iter()
        .filter_map(Value::as_object)
        .flat_map(|s| s.keys())
    {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let column = |key: &String| {
        let value = |section: &Value| match &section[key] {
            Value::String(text) => text.clone(),
            Value::Null => "–".to_owned(),
            other => other.to_string(),
        };
        let name = name.iter().cloned().chain([text::words(key)]).collect();
        (name, sections.iter().map(value).collect())
    };
    keys.into_iter().map(column).collect()
}

/// A section as people read it: «from eq5, youngs modulus 207 GPa».
fn section_in_words(value: &str) -> String {
    match serde_json::from_str(value) {
        Ok(Value::Object(section)) => {
            let parts = section.iter().map(|(key, value)| {
                let value = value
                    .as_str()
                    .map_or_else(|| value.to_string(), str::to_owned);
                format!("{} {value}", text::words(key))
            });
            parts.collect::<Vec<_>>().join(", ")
        }
        _ => value.to_owned(),
    }
}

/// One name for what goes together: «contact damping (big end, small end)».
fn one_name(names: &[Vec<String>]) -> String {
    let shortest = names.iter().map(Vec::len).min().unwrap_or(0);
    let same = |back: &usize| {
        let last = |name: &Vec<String>| name[name.len() - back].clone();
        names.iter().all(|other| last(other) == last(&names[0]))
    };
    let common = (1..shortest).take_while(same).count();
    if names.len() == 1 || common == 0 {
        let names = names.iter().map(|name| name.join(" "));
        return names.collect::<Vec<_>>().join(", ");
    }
    let own = names
        .iter()
        .map(|name| name[..name.len() - common].join(" "));
    let shared = names[0][names[0].len() - common..].join(" ");
    format!("{shared} ({})", own.collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_together_has_one_name() {
        let name =
            |paths: &[&str]| one_name(&paths.iter().map(|p| segments(p)).collect::<Vec<_>>());
        assert_eq!(
            name(&[
                "joints.big_end.contact.damping",
                "joints.small_end.contact.damping"
            ]),
            "contact damping (big end, small end)"
        );
        assert_eq!(name(&["speed"]), "speed");
        assert_eq!(
            name(&["speed", "cylinder.suction"]),
            "speed, cylinder suction"
        );
    }

    #[test]
    fn sections_are_taken_apart() {
        let sections = [
            r#"{"from":"eq5","poisson_ratio":0.3}"#,
            r#"{"from":"conformal"}"#,
        ];
        let name = segments("joints.big_end.contact.stiffness");
        let columns = parts(&name, &sections);
        assert_eq!(columns[0].0.join(" "), "big end contact stiffness from");
        assert_eq!(columns[0].1, ["eq5", "conformal"]);
        assert_eq!(columns[1].1, ["0.3", "–"]);
        let mixed = parts(&name, &["24 GN/m^1.5", sections[1]]);
        assert_eq!(mixed[0].1, ["24 GN/m^1.5", "from conformal"]);
    }
}
