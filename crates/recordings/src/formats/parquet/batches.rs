//! The rows of several Parquet files as one stream of Arrow record batches, decoded as they are asked for.

use super::read::{ParquetFile, damaged, guarded};
use crate::Error;
use arrow_array::{RecordBatch, RecordBatchReader};
use arrow_schema::SchemaRef;
use arrow_schema::ArrowError;
use parquet::arrow::arrow_reader::ParquetRecordBatchReader;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Some columns of several files of the same columns, file after file.
pub struct Batches {
    paths: std::vec::IntoIter<PathBuf>,
    columns: Option<Vec<String>>,
    current: Option<(PathBuf, ParquetRecordBatchReader)>,
    schema: SchemaRef,
}

impl Batches {
    /// The columns of these names, or all of them, of the files at `paths`.
    ///
    /// # Errors
    /// When there is no file, the first cannot be read, or it lacks a column. Those of the others are found on
    /// the way.
    pub fn new(paths: Vec<PathBuf>, columns: Option<Vec<String>>) -> Result<Self, Error> {
        let mut paths = paths.into_iter();
        let first = paths.next().ok_or(Error::NoFiles)?;
        let reader = open(&first, columns.as_deref(), None)?;
        Ok(Self {
            schema: reader.schema(),
            paths,
            columns,
            current: Some((first, reader)),
        })
    }

    /// The same of these rows of the file at `path`.
    ///
    /// # Errors
    /// As [`Batches::new`], and where there are no such rows.
    pub fn of_rows(
        path: &Path,
        columns: Option<Vec<String>>,
        rows: Range<usize>,
    ) -> Result<Self, Error> {
        let reader = open(path, columns.as_deref(), Some(rows))?;
        Ok(Self {
            schema: reader.schema(),
            paths: Vec::new().into_iter(),
            columns,
            current: Some((path.to_owned(), reader)),
        })
    }

    fn advance(&mut self) -> Result<Option<RecordBatch>, Error> {
        loop {
            if let Some((path, reader)) = &mut self.current {
                let batch = guarded(path, || reader.next().transpose().map_err(damaged(path)))?;
                if batch.is_some() {
                    return Ok(batch);
                }
            }
            let Some(path) = self.paths.next() else {
                return Ok(None);
            };
            let reader = open(&path, self.columns.as_deref(), None)?;
            if reader.schema().fields() != self.schema.fields() {
                return Err(damaged(&path)("it has other columns than the files before"));
            }
            self.current = Some((path, reader));
        }
    }
}

fn open(
    path: &Path,
    columns: Option<&[String]>,
    rows: Option<Range<usize>>,
) -> Result<ParquetRecordBatchReader, Error> {
    let file = ParquetFile::open(path)?;
    let rows = rows.unwrap_or(0..file.rows());
    file.check_rows(&rows)?;
    let all = file.schema().columns().iter().map(|c| c.name.as_str());
    let names: Vec<&str> = match columns {
        Some(columns) => columns.iter().map(String::as_str).collect(),
        None => all.collect(),
    };
    for name in &names {
        file.wanted(name)?;
    }
    guarded(path, || file.batches(&names, rows.clone()))
}

impl Iterator for Batches {
    type Item = Result<RecordBatch, ArrowError>;

    fn next(&mut self) -> Option<Self::Item> {
        let read = self.advance();
        if read.is_err() {
            self.paths = Vec::new().into_iter();
            self.current = None;
        }
        read.map_err(|error| ArrowError::ExternalError(Box::new(error)))
            .transpose()
    }
}

impl RecordBatchReader for Batches {
    fn schema(&self) -> SchemaRef {
        self.schema.clone()
    }
}
