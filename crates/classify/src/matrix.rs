//! Numbers for a classifier.

use std::collections::BTreeSet;

/// Rows of numbers, column after column. A missing value is NaN; infinite ones count as missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matrix {
    columns: Vec<Vec<f64>>,
    rows: usize,
}

impl Matrix {
    /// Of `columns` with `rows` values each.
    ///
    /// # Panics
    /// If a column has another number of values.
    pub fn new(columns: Vec<Vec<f64>>, rows: usize) -> Self {
        for column in &columns {
            assert_eq!(column.len(), rows, "columns of one length");
        }
        Self { columns, rows }
    }

    /// Values of a column.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The columns.
    pub fn columns(&self) -> &[Vec<f64>] {
        &self.columns
    }

    /// This one, with the rows of `other` below its own.
    ///
    /// # Panics
    /// If the other has another number of columns.
    pub fn above(mut self, other: &Self) -> Self {
        assert_eq!(self.columns.len(), other.columns.len(), "the same columns");
        for (column, more) in self.columns.iter_mut().zip(&other.columns) {
            column.extend(more);
        }
        self.rows += other.rows;
        self
    }

    /// Some of its rows, in this order.
    pub fn select(&self, rows: &[usize]) -> Self {
        let select = |column: &Vec<f64>| rows.iter().map(|row| column[*row]).collect();
        Self {
            columns: self.columns.iter().map(select).collect(),
            rows: rows.len(),
        }
    }

    /// One value.
    pub fn value(&self, row: usize, column: usize) -> f64 {
        self.columns[column][row]
    }
}

/// Rows of features, and which of them belong together: windows of one recording are no independent samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    /// The features.
    pub values: Matrix,
    /// A name for each row; rows of one name are never on both sides of a split.
    pub groups: Vec<String>,
}

impl Sample {
    /// Groups that differ.
    pub fn distinct(&self) -> usize {
        self.groups.iter().collect::<BTreeSet<_>>().len()
    }
}
