//! machine.yaml: a compressor with its sensors, every value with its unit.
//!
//! A machine of one throw has the sections `rod`, `crosshead`, `cylinder` and `joints` at the top.
//! A machine of several has a list `throws`; what stands at the top then holds for every throw
//! that does not say otherwise, key by key.

mod contact;
pub(crate) mod effects;
mod joints;
mod normal_clearance;
mod relation;
mod resolved;
mod sections;
mod sensors;
mod shared;
mod surfaces;
mod top_sections;
mod value;

pub use normal_clearance::{NormalClearance, ThrowNormalClearance};
pub(crate) use relation::RelationSection;
pub use resolved::Resolved;
pub use sensors::sensor_section;
pub(crate) use top_sections::Sections;
pub(crate) use value::unit_of_quantity;

use crate::error::Error;
use crate::yaml::{self, Document};
use crate::{reader, schema};
use serde_json::Value;
use std::path::Path;

/// A machine file whose keys, units and ranges have been checked one by one.
#[derive(Clone, Debug)]
pub struct MachineFile {
    document: Document,
    sections: Sections,
}

/// Reads the machine file at `path`.
///
/// # Errors
/// The first key, unit or value that cannot stand where it does, with its line.
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

    fn from_document(document: Document) -> Result<Self, Error> {
        let spread = shared::spread(&document.tree);
        match reader::read(&spread) {
            Ok(sections) => Ok(Self { document, sections }),
            Err(error) => Err(locate(&document, error)),
        }
    }

    /// The file's content, as it is written.
    pub fn to_tree(&self) -> &Value {
        &self.document.tree
    }

    /// The file's content as YAML: reading it gives the same machine.
    ///
    /// # Errors
    /// Where the content has a form that YAML cannot hold.
    pub fn to_yaml(&self) -> Result<String, Error> {
        yaml::to_string(&self.document.tree)
    }

    /// The machine, its sensors and its limits, in SI units.
    ///
    /// # Errors
    /// The first value that does not go together with the others, with its line: a rod shorter
    /// than its crank, a clearance wider than its journal, ...
    pub fn resolve(&self) -> Result<Resolved, Error> {
        self.sections
            .resolve()
            .map_err(|error| locate(&self.document, error))
    }
}

/// `error` with its line in the file, and with what belongs in the place of a missing key. A key of a
/// throw may stand in the section that the throws share.
fn locate(document: &Document, error: Error) -> Error {
    let key = shared::written_key(&document.tree, error.key()).to_owned();
    let error = error.with_key(key.clone());
    document.locate(error.expecting(|| schema::Node::machine().walk(&key)?.expected()))
}
