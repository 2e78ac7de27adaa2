//! A column of a table of a dataset, as pages list it.

/// A column of a table of the dataset.
#[derive(Clone, Debug)]
pub struct Column {
    /// The table: `signals` or `features`.
    pub table: String,
    /// Its name.
    pub name: String,
    /// Its type, for instance `list<float32>`.
    pub kind: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// What it is.
    pub meaning: String,
}
