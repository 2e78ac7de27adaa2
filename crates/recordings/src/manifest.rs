//! `manifest.json`: what a dataset consists of, for programs.

use crate::{Column, Error, Schema, shell};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Longest manifest, in bytes: 1 GiB. One of a million files has a fifth of that.
const LONGEST: u64 = 1 << 30;

/// What a dataset consists of. A folder without it is not a complete dataset.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of the program that wrote the dataset.
    pub version: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// How many cases and rows there are.
    pub counts: Counts,
    /// The columns of each table, in their order: `columns["features"]`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub columns: BTreeMap<String, Vec<ColumnEntry>>,
    /// Every other file of the dataset, sorted by path.
    pub files: Vec<FileEntry>,
    /// The cases that have no row, sorted by identifier.
    pub failed: Vec<FailedCase>,
    /// What is doubtful about cases that have rows, sorted by identifier.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<CaseWarning>,
}

/// A column of a table of a dataset.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ColumnEntry {
    /// Its name.
    pub name: String,
    /// Its [`crate::Role`], by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub role: Option<String>,
    /// What its values are: `text`, `integer`, `real`, `flag` or `samples`.
    pub holds: String,
    /// Unit of the values, where they have one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// What the values mean.
    pub description: String,
}

impl ColumnEntry {
    /// The columns of a table.
    pub fn from_schema(schema: &Schema) -> Vec<Self> {
        schema.columns().iter().map(Self::from).collect()
    }
}

impl From<&Column> for ColumnEntry {
    fn from(column: &Column) -> Self {
        Self {
            name: column.name.clone(),
            role: column.role.map(|role| role.name().to_owned()),
            holds: column.kind.name().to_owned(),
            unit: column.unit.clone(),
            description: column.description.clone(),
        }
    }
}

/// Something doubtful about a case that was simulated.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CaseWarning {
    /// Identifier of the case.
    pub case_id: String,
    /// What it is, and what to do.
    pub warning: String,
}

/// How many cases and rows a dataset has.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Cases of the sweep.
    pub cases: u64,
    /// Cases that failed.
    pub failed: u64,
    /// Rows by split, then by fault: `rows["train"]["big_end"]`.
    pub rows: BTreeMap<String, BTreeMap<String, u64>>,
}

/// One file of a dataset.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileEntry {
    /// Path within the dataset, with `/` between folders.
    pub path: String,
    /// Length in bytes.
    pub bytes: u64,
    /// SHA-256 of the content, in hexadecimal.
    pub sha256: String,
    /// Rows, where the file is a table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rows: Option<u64>,
}

/// A case that could not be simulated.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FailedCase {
    /// Identifier of the case.
    pub case_id: String,
    /// Why it failed, with the time at which it did.
    pub reason: String,
    /// The command that runs this case alone.
    pub command: String,
    /// Whether the process that simulated it died, where the others end with a reason of their own.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub died: bool,
}

impl FailedCase {
    /// The command that runs the case `case_id` alone, where the sweep file is at `sweep`.
    pub fn command_of(sweep: &Path, case_id: &str) -> String {
        let [sweep, case] = [&sweep.display().to_string(), case_id].map(shell::word);
        format!("crosshead simulate {sweep} --case {case}")
    }

    /// The command that runs this case alone, from anywhere, of the dataset in `folder`. For a dataset in
    /// object storage it runs from where its `sweep.yaml` has been copied to. It is made anew, because the record of a
    /// dataset from elsewhere may hold any other command.
    pub fn command_in(&self, folder: &Path) -> String {
        let sweep = match folder.starts_with("s3:") {
            true => "sweep.yaml".into(),
            false => folder.join("sweep.yaml"),
        };
        Self::command_of(&sweep, &self.case_id)
    }
}

impl Manifest {
    /// The manifest as it is written: indented, with a newline at the end.
    ///
    /// # Errors
    /// None in practice: everything in it has a form in JSON.
    pub fn to_json(&self) -> Result<String, Error> {
        let json = serde_json::to_string_pretty(self).map_err(|e| Error::encode("JSON", e))?;
        Ok(json + "\n")
    }

    /// The manifest of a file.
    ///
    /// # Errors
    /// When the file is not there or is not a manifest.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = files::read_text(path, LONGEST).map_err(Error::io("read", path))?;
        Self::from_json(&text, path)
    }

    /// The manifest that is written as `text`; messages call its file `path`.
    ///
    /// # Errors
    /// When it is not a manifest.
    pub fn from_json(text: &str, path: &Path) -> Result<Self, Error> {
        serde_json::from_str(text).map_err(|error| Error::Damaged {
            format: "a manifest",
            path: path.to_owned(),
            reason: error.to_string(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_is_no_manifest_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("manifest.json");
        let message = || Manifest::read(&path).unwrap_err().to_string();
        assert!(message().starts_with("cannot read `"), "{}", message());
        fs::write(&path, r#"{"version": "0.1.0", "seed": -1}"#).unwrap();
        assert!(
            message().contains("as a manifest: invalid value: integer `-1`"),
            "{}",
            message()
        );
    }
}
