//! The features of a dataset, or of recordings, as numbers for a classifier.

use super::{Dataset, Error, Subset};
use classify::{Matrix, Sample};
use recordings::{Column, Kind, Role, Table};

/// Names of the features that are numbers, in the order of the columns.
pub fn numeric_features(columns: &[Column]) -> Vec<String> {
    let numbers = columns.iter().filter(|column| {
        column.role == Some(Role::Feature) && matches!(column.kind, Kind::Real | Kind::Integer)
    });
    numbers.map(|column| column.name.clone()).collect()
}

/// These columns of a table, NaN where a value is missing.
///
/// # Errors
/// A column that is not there or holds no numbers.
pub fn matrix(table: &Table, names: &[String]) -> Result<Matrix, recordings::Error> {
    let columns = names.iter().map(|name| {
        let column = table.schema().columns().iter().find(|c| c.name == *name);
        match column.map(|column| column.kind) {
            Some(Kind::Integer) => {
                let values = table.values::<i64>(name)?.iter();
                Ok(values
                    .map(|value| value.map_or(f64::NAN, |v| v as f64))
                    .collect())
            }
            _ => Ok(super::numbers(table, name)?.collect()),
        }
    });
    Ok(Matrix::new(
        columns.collect::<Result<_, recordings::Error>>()?,
        table.rows(),
    ))
}

impl Dataset {
    /// The features that are numbers, their names and their rows with a label: of one split, or of all. Rows of one group
    /// differ in noise and sensors alone.
    ///
    /// # Errors
    /// A table that cannot be read or is not the one that was written.
    pub fn sample(&self, split: Option<&str>, label: &str) -> Result<LabelledSample, Error> {
        let names = numeric_features(&self.columns(Subset::Features)?);
        let mut all = LabelledSample {
            sample: Sample {
                values: Matrix::new(vec![Vec::new(); names.len()], 0),
                groups: Vec::new(),
            },
            labels: Vec::new(),
            names,
        };
        let prefix = split.map(|split| format!("{}/{split}-", Subset::Features.name()));
        for path in self.files.paths(Subset::Features) {
            if prefix
                .as_ref()
                .is_some_and(|prefix| !path.starts_with(prefix))
            {
                continue;
            }
            let file = self.files.open(&path)?;
            let mut columns: Vec<&str> = all.names.iter().map(String::as_str).collect();
            columns.extend(["group", label]);
            let read = |table: &Table| {
                let groups: Vec<String> = super::texts(table, "group")?.collect();
                let labels: Vec<String> = super::texts(table, label)?.collect();
                Ok((matrix(table, &all.names)?, groups, labels))
            };
            let (values, groups, labels) =
                self.files
                    .read(&path, &file, &columns, 0..file.rows(), read)?;
            all.sample.values = all.sample.values.above(&values);
            all.sample.groups.extend(groups);
            all.labels.extend(labels);
        }
        Ok(all)
    }
}

/// Rows of features with what they are to be told by.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelledSample {
    /// Names of the columns.
    pub names: Vec<String>,
    /// The rows.
    pub sample: Sample,
    /// The label of each row.
    pub labels: Vec<String>,
}
