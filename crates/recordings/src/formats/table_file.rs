//! A table that is written row by row, in the format that the ending of its name says.

use super::csv::write_table;
use super::parquet::{PENDING_ROWS, TableWriter};
use crate::{Error, Schema, Table, Value, WholeFile};
use std::path::Path;

/// The format of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// Apache Parquet.
    Parquet,
    /// Comma-separated values.
    Csv,
}

impl TableFormat {
    /// The format of a file with this name; none where its ending names none.
    pub fn from_path(path: &Path) -> Option<Self> {
        let ending = path.extension().unwrap_or_default().to_string_lossy();
        match ending.to_ascii_lowercase().as_str() {
            "parquet" => Some(Self::Parquet),
            "csv" => Some(Self::Csv),
            _ => None,
        }
    }
}

/// A file under way.
pub enum TableFile {
    /// Rows are written group by group.
    Parquet(Box<TableWriter<WholeFile>>),
    /// Rows are kept until the end.
    Csv(Box<(WholeFile, Table)>),
}

impl TableFile {
    /// A table without rows that is written into `file`.
    ///
    /// # Errors
    /// Columns that the format does not have.
    pub fn new(file: WholeFile, format: TableFormat, schema: &Schema) -> Result<Self, Error> {
        Ok(match format {
            TableFormat::Parquet => {
                Self::Parquet(Box::new(TableWriter::new(file, schema, PENDING_ROWS)?))
            }
            TableFormat::Csv => Self::Csv(Box::new((file, Table::new(schema.clone())))),
        })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A row that does not fit the columns, or a file that cannot be written.
    pub fn write(&mut self, row: Vec<Value>) -> Result<(), Error> {
        match self {
            Self::Parquet(writer) => writer.write(row),
            Self::Csv(under_way) => under_way.1.push(row),
        }
    }

    /// Makes the file appear, whole.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn commit(self) -> Result<(), Error> {
        let file = match self {
            Self::Parquet(writer) => writer.finish(),
            Self::Csv(under_way) => {
                let (file, table) = *under_way;
                write_table(file, &table)
            }
        };
        file.and_then(WholeFile::commit).map(drop)
    }
}
