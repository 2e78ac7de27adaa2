//! The table that is written: Parquet or CSV, as the ending of its name says.

use super::ROWS_PER_GROUP;
use crate::Failure;
use recordings::formats::csv::write_table;
use recordings::formats::parquet::TableWriter;
use recordings::{Schema, Table, Value, WholeFile};
use std::path::Path;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Parquet,
    Csv,
}

impl Format {
    /// The format of a file with this name.
    pub(super) fn of(out: &Path) -> Result<Self, Failure> {
        let shown = out.display();
        if out.is_dir() {
            return Err(Failure::input(format!(
                "--out: {shown} is a folder, expected a file, e.g. features.parquet"
            )));
        }
        let ending = out.extension().unwrap_or_default().to_string_lossy();
        match ending.to_ascii_lowercase().as_str() {
            "parquet" => Ok(Self::Parquet),
            "csv" => Ok(Self::Csv),
            _ => Err(Failure::input(format!(
                "--out: found {shown}, expected a name that ends in .parquet or .csv"
            ))),
        }
    }
}

/// A table under way.
pub(super) enum Output {
    Parquet(Box<TableWriter<WholeFile>>),
    Csv(Box<(WholeFile, Table)>),
}

impl Output {
    pub(super) fn create(out: &Path, format: Format, schema: &Schema) -> Result<Self, Failure> {
        let file = WholeFile::create(&out.with_extension("part"), out).map_err(Failure::input)?;
        Ok(match format {
            Format::Parquet => {
                let writer = TableWriter::new(file, schema, ROWS_PER_GROUP);
                Self::Parquet(Box::new(writer.map_err(Failure::work)?))
            }
            Format::Csv => Self::Csv(Box::new((file, Table::new(schema.clone())))),
        })
    }

    pub(super) fn write(&mut self, row: Vec<Value>) -> Result<(), Failure> {
        match self {
            Self::Parquet(writer) => writer.write(row),
            Self::Csv(under_way) => under_way.1.push(row),
        }
        .map_err(Failure::work)
    }

    pub(super) fn commit(self) -> Result<(), Failure> {
        let file = match self {
            Self::Parquet(writer) => writer.finish(),
            Self::Csv(under_way) => {
                let (file, table) = *under_way;
                write_table(file, &table)
            }
        };
        file.and_then(WholeFile::commit).map_err(Failure::work)?;
        Ok(())
    }
}
