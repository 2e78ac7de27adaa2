//! What a table holds: its columns, with their units and meanings.

use crate::{Error, Kind};
use std::collections::{BTreeMap, BTreeSet};

/// What a column is to those who learn from a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// What names a row, and the rows that belong together.
    Identifier,
    /// What is to be found out: the fault, and how large it is.
    Label,
    /// At what the machine ran, and what else was chosen.
    Condition,
    /// What varied without being known.
    Unknown,
    /// A number or a word computed from a recording.
    Feature,
    /// A recording.
    Signal,
}

impl Role {
    /// All roles, in the order in which tables and cards have them.
    pub const ALL: [Self; 6] = [
        Self::Identifier,
        Self::Label,
        Self::Condition,
        Self::Unknown,
        Self::Feature,
        Self::Signal,
    ];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Identifier => "identifier",
            Self::Label => "label",
            Self::Condition => "condition",
            Self::Unknown => "unknown",
            Self::Feature => "feature",
            Self::Signal => "signal",
        }
    }

    /// The role of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.name() == name)
    }
}

/// A column: what stands in it and in which unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name, ending in the unit where there is one: `clearance_m`.
    pub name: String,
    /// What the values are.
    pub kind: Kind,
    /// Unit of the values as people write it: `m`, `m/s^2`. None for what has no unit.
    pub unit: Option<String>,
    /// What the values mean, in a sentence.
    pub description: String,
    /// What it is to those who learn from the table.
    pub role: Option<Role>,
    /// Whether a value may be missing (null in files).
    pub optional: bool,
}

impl Column {
    /// A column without a unit in which no value may be missing.
    pub fn new(name: impl Into<String>, kind: Kind, description: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            kind,
            unit: None,
            description: description.into(),
            role: None,
            optional: false,
        }
    }

    /// The same column with a unit.
    pub fn unit(self, unit: impl Into<String>) -> Self {
        Self {
            unit: Some(unit.into()),
            ..self
        }
    }

    /// The same column with a role.
    pub fn role(self, role: Role) -> Self {
        Self {
            role: Some(role),
            ..self
        }
    }

    /// The same column, in which values may be missing.
    pub fn optional(self) -> Self {
        Self {
            optional: true,
            ..self
        }
    }
}

/// The columns of a table, each name once, and what holds for the whole table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Schema {
    columns: Vec<Column>,
    metadata: BTreeMap<String, String>,
}

impl Schema {
    /// A schema of these columns, in this order.
    ///
    /// # Errors
    /// When a column has no name, or two have the same.
    pub fn new(columns: Vec<Column>) -> Result<Self, Error> {
        let mut names = BTreeSet::new();
        for (i, column) in columns.iter().enumerate() {
            if column.name.is_empty() {
                return Err(Error::NamelessColumn(i));
            }
            if !names.insert(&column.name) {
                return Err(Error::DuplicateColumn(column.name.clone()));
            }
        }
        Ok(Self {
            columns,
            metadata: BTreeMap::new(),
        })
    }

    /// The same schema with keys and values that hold for the whole table
    /// (`sample_rate_hz`, `version`, ...); they are kept in the file's metadata.
    pub fn with_metadata(self, metadata: BTreeMap<String, String>) -> Self {
        Self { metadata, ..self }
    }

    /// The same schema with these columns alone, in this order, each at most once.
    pub fn select(&self, columns: &[usize]) -> Self {
        Self {
            columns: columns.iter().map(|i| self.columns[*i].clone()).collect(),
            metadata: self.metadata.clone(),
        }
    }

    /// The columns, in order.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// What holds for the whole table.
    pub fn metadata(&self) -> &BTreeMap<String, String> {
        &self.metadata
    }

    /// Where the column of that name stands.
    ///
    /// # Errors
    /// When there is no such column; the message lists the columns.
    pub fn position(&self, name: &str) -> Result<usize, Error> {
        let found = self.columns.iter().position(|column| column.name == name);
        found.ok_or_else(|| Error::NoColumn {
            name: name.to_owned(),
            among: self.columns.iter().map(|c| c.name.clone()).collect(),
        })
    }
}
