//! machine.yaml: a compressor with its sensors, every value with its unit.
//!
//! A machine of one throw has the sections `rod`, `crosshead`, `cylinder` and `joints` at the top.
//! A machine of several has a list `throws`; what stands at the top then holds for every throw
//! that does not say otherwise, key by key.

mod ambient;
mod contact;
pub(crate) mod effects;
mod joints;
mod materials;
mod normal_clearance;
mod relation;
mod resolved;
mod sections;
mod sensors;
mod shared;
mod surfaces;
pub(crate) mod synonyms;
mod top_sections;
mod value;
mod written;

pub use normal_clearance::{NormalClearance, ThrowNormalClearance};
pub(crate) use relation::RelationSection;
pub use resolved::Resolved;
pub use sensors::sensor_section;
pub use synonyms::synonyms;
pub(crate) use top_sections::Sections;
pub(crate) use value::unit_of_quantity;

use crate::error::Error;
use crate::yaml::{self, Document};
use crate::{paths, reader, schema};
use serde_json::{Map, Value};
use std::path::Path;
use written::{Mistakes, Written};

/// A machine file whose keys, units and ranges have been checked one by one.
#[derive(Clone, Debug)]
pub struct MachineFile {
    document: Document,
    written: Written,
    sections: Sections,
}

/// Reads the machine file at `path`.
///
/// # Errors
/// All mistakes, with their lines: of keys, units and values, and of what does not go together.
pub fn read(path: &Path) -> Result<MachineFile, Error> {
    MachineFile::from_document(Document::open(path)?)
}

impl MachineFile {
    /// Reads the text of a machine file that messages call `file_name`.
    ///
    /// # Errors
    /// As [`read`].
    pub fn from_yaml(text: &str, file_name: &str) -> Result<Self, Error> {
        Self::from_document(Document::parse(text, file_name)?)
    }

    /// The machine file with the content `tree`, which a sweep may have changed.
    ///
    /// # Errors
    /// As [`read`], without lines.
    pub fn from_tree(tree: &Value) -> Result<Self, Error> {
        Self::from_document(Document::from_tree(tree.clone()))
    }

    /// Reads the machine file with the content `document`.
    ///
    /// # Errors
    /// As [`read`].
    pub fn from_document(document: Document) -> Result<Self, Error> {
        let Parts { written, sections } = match Parts::read(&document.tree) {
            Ok(parts) if document.faults().is_empty() => parts,
            // A file with a wrong key may also have values that do not go together.
            _ => all(&document, |tree| {
                let parts = Parts::read(tree)?;
                parts.resolve().map(|_| parts)
            })?,
        };
        Ok(Self {
            document,
            written,
            sections,
        })
    }

    /// The machine file with the content `document` and what it describes; with mistakes, these, and what the file
    /// says without them where that can be told: whatever refers to the machine can be checked all the same.
    pub fn checked(document: Document) -> (Option<(Self, Resolved)>, Option<Error>) {
        let file = Self::from_document(document.clone());
        let error = match file.and_then(|file| file.resolve().map(|resolved| (file, resolved))) {
            Ok(good) => return (Some(good), None),
            Err(error) => error,
        };
        let mut read = |tree: &Value| Parts::read(tree)?.resolve().map(|_| ());
        let (_, tree) = document.mistakes(&schema::MACHINE, &synonyms::canonical, &mut read);
        let file = Self::from_tree(&tree);
        let repaired = file.and_then(|file| file.resolve().map(|resolved| (file, resolved)));
        (repaired.ok(), Some(error))
    }

    /// The same machine with other values, each at its path (`joints.big_end.clearance`).
    ///
    /// # Errors
    /// Where the format has no such path ([`paths::set`]), and as [`read`], without lines.
    pub fn with_values<'a>(
        &self,
        values: impl IntoIterator<Item = (&'a str, Value)>,
    ) -> Result<Self, Error> {
        let mut tree = self.written.tree.clone();
        for (path, value) in values {
            paths::set(&mut tree, path, value)?;
        }
        Self::from_tree(&tree)
    }

    /// The same machine with those sensors alone that give some of the channels of these names.
    ///
    /// # Errors
    /// A channel that no sensor gives.
    pub fn with_channels(&self, channels: &[String]) -> Result<Self, Error> {
        let mut tree = self.written.tree.clone();
        let listed = tree["sensors"].as_array().cloned().unwrap_or_default();
        let (mut kept, mut given) = (Vec::new(), Vec::new());
        for sensor in listed {
            tree["sensors"] = Value::Array(vec![sensor.clone()]);
            let alone = Self::from_tree(&tree)?.resolve()?;
            let throws = alone.machine.throw_names();
            let columns = alone.sensors.iter().map(|s| s.measured.column(&throws));
            let columns: Vec<String> = columns.collect();
            if columns.iter().any(|column| channels.contains(column)) {
                kept.push(sensor);
            }
            given.extend(columns);
        }
        if let Some(unknown) = channels.iter().find(|name| !given.contains(name)) {
            let given: Vec<&str> = given.iter().map(String::as_str).collect();
            return Err(Error::unknown_name("channels", unknown, &given));
        }
        tree["sensors"] = Value::Array(kept);
        Self::from_tree(&tree)
    }

    /// The file's content, with the keys of machine files in the place of their synonyms.
    pub fn to_tree(&self) -> &Value {
        &self.written.tree
    }

    /// The file's content as YAML: reading it gives the same machine.
    ///
    /// # Errors
    /// Where the content has a form that YAML cannot hold.
    pub fn to_yaml(&self) -> Result<String, Error> {
        yaml::to_string(&self.written.tree)
    }

    /// The machine, its sensors and its limits, in SI units.
    ///
    /// # Errors
    /// All values that do not go together with the others, with their lines: a rod shorter than its crank, a
    /// clearance wider than its journal, ...
    pub fn resolve(&self) -> Result<Resolved, Error> {
        match resolve(&self.written, &self.sections) {
            Ok(resolved) => Ok(resolved),
            Err(_) => all(&self.document, |tree| Parts::read(tree)?.resolve()),
        }
    }
}

/// The key of a throw's section at the key of a throw, and of any other place this key.
pub(crate) fn canonical_key(key: &str) -> String {
    let throw = key
        .strip_prefix("throws.")
        .and_then(|rest| rest.split_once('.'));
    throw.map_or(key, |(_, rest)| rest).to_owned()
}

/// Whether a section has keys that machine files alone have.
pub(crate) fn is_machine_file(section: &Map<String, Value>) -> bool {
    let own = [
        "rod",
        "crosshead",
        "cylinder",
        "joints",
        "sensors",
        "speed",
        "gravity",
    ];
    let is_own = |key: &String| own.contains(&key.as_str()) || synonyms::is_of_people(key);
    section.keys().any(is_own)
}

/// The content `tree` of a machine file, with the keys of machine files in the place of their synonyms.
///
/// # Errors
/// A synonym whose value cannot be, or that says what its key says, too.
pub(crate) fn canonical(tree: &Value) -> Result<Value, Error> {
    let mut written = Written::new(tree.clone());
    let mut mistakes = Mistakes::default();
    synonyms::replace(&mut written, &mut mistakes);
    ambient::make_absolute(&mut written);
    materials::replace(&mut written, &mut mistakes);
    mistakes.into_error()?;
    Ok(written.tree)
}

/// What `read` makes of a machine file, or all mistakes that it finds.
fn all<T>(document: &Document, read: impl FnMut(&Value) -> Result<T, Error>) -> Result<T, Error> {
    document.collect_named(|| schema::MACHINE.clone(), &synonyms::canonical, read)
}

/// The content of a machine file, read.
struct Parts {
    written: Written,
    sections: Sections,
}

impl Parts {
    /// Reads `tree`, whose keys errors have.
    fn read(tree: &Value) -> Result<Self, Error> {
        let mut written = Written::new(tree.clone());
        let mut mistakes = Mistakes::default();
        synonyms::replace(&mut written, &mut mistakes);
        ambient::make_absolute(&mut written);
        materials::replace(&mut written, &mut mistakes);
        mistakes.into_error()?;
        let spread = joints::name_ideal(shared::spread(&written.tree));
        match reader::read(&spread) {
            Ok(sections) => Ok(Self { written, sections }),
            Err(error) => Err(named(&written, error)),
        }
    }

    fn resolve(&self) -> Result<Resolved, Error> {
        resolve(&self.written, &self.sections)
    }
}

fn resolve(written: &Written, sections: &Sections) -> Result<Resolved, Error> {
    let resolved = sections.resolve();
    resolved.map_err(|error| named(written, error))
}

/// What is to be said of a key for something that no machine file can state; none for any other key.
fn not_modelled(name: &str) -> Option<&'static str> {
    let is_tail_rod = name.starts_with("tail_rod") || name.starts_with("tailrod");
    is_tail_rod.then_some(
        "a tail rod is not modelled: leave the key out; the head end then has the area of the whole piston, which is too \
         large by that of the tail rod",
    )
}

/// `error` with the key that the file has, and with what belongs in the place of a missing one. A key of a throw
/// may stand in the section that the throws share.
fn named(written: &Written, error: Error) -> Error {
    let error = error.renamed(&|key| shared::written_key(&written.tree, key).to_owned());
    let key = error.key().to_owned();
    let error = error.expecting(|| schema::machine().walk(&key)?.expected());
    let (above, own) = key.rsplit_once('.').unwrap_or(("", &key));
    let error = match not_modelled(own) {
        Some(words) => error.not_modelled(words),
        None => error.suggesting(synonyms::names_in(above)),
    };
    let error = error.meaning(&synonyms::joint_called);
    let error = error.showing(&|key| written.own_value(key));
    error.renamed(&|key| written.original(key))
}
