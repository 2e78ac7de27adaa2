//! A table in memory: the values of its columns, checked against the schema.

use crate::{Column, Error, Kind, Schema};

/// The most samples that one row of one column holds (4 GiB of float32).
///
/// Arrow counts the samples of a batch with 31 bits; half of that leaves room for the rest of it.
const MOST_SAMPLES: usize = 1 << 30;

/// One value of a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A string.
    Text(String),
    /// A whole number.
    Integer(i64),
    /// A real number.
    Real(f64),
    /// True or false.
    Flag(bool),
    /// A recording.
    Samples(Vec<f32>),
    /// No value; only in an optional column.
    Missing,
}

/// The values of one column; `None` where one is missing.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// Strings.
    Text(Vec<Option<String>>),
    /// Whole numbers.
    Integer(Vec<Option<i64>>),
    /// Real numbers.
    Real(Vec<Option<f64>>),
    /// Flags.
    Flag(Vec<Option<bool>>),
    /// Recordings.
    Samples(Vec<Option<Vec<f32>>>),
}

/// The Rust type of the values of one [`Kind`] of column.
pub trait Cell: Sized + Into<Value> {
    /// The kind of column that holds such values.
    const KIND: Kind;
    /// The values of a column; `None` when it holds another kind.
    fn values(data: &Data) -> Option<&[Option<Self>]>;
}

macro_rules! cell {
    ($type:ty, $variant:ident) => {
        impl From<$type> for Value {
            fn from(value: $type) -> Self {
                Self::$variant(value)
            }
        }

        impl Cell for $type {
            const KIND: Kind = Kind::$variant;

            fn values(data: &Data) -> Option<&[Option<Self>]> {
                match data {
                    Data::$variant(values) => Some(values),
                    _ => None,
                }
            }
        }
    };
}

cell!(String, Text);
cell!(i64, Integer);
cell!(f64, Real);
cell!(bool, Flag);
cell!(Vec<f32>, Samples);

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Missing, Into::into)
    }
}

/// The same expression for the values of any kind of column.
macro_rules! each {
    ($data:expr, $values:ident => $result:expr) => {
        match $data {
            Data::Text($values) => $result,
            Data::Integer($values) => $result,
            Data::Real($values) => $result,
            Data::Flag($values) => $result,
            Data::Samples($values) => $result,
        }
    };
}

impl Data {
    /// A column without values.
    pub fn empty(kind: Kind) -> Self {
        match kind {
            Kind::Text => Self::Text(Vec::new()),
            Kind::Integer => Self::Integer(Vec::new()),
            Kind::Real => Self::Real(Vec::new()),
            Kind::Flag => Self::Flag(Vec::new()),
            Kind::Samples => Self::Samples(Vec::new()),
        }
    }

    /// What the values are.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Text(_) => Kind::Text,
            Self::Integer(_) => Kind::Integer,
            Self::Real(_) => Kind::Real,
            Self::Flag(_) => Kind::Flag,
            Self::Samples(_) => Kind::Samples,
        }
    }

    /// Number of values, missing ones included.
    pub fn len(&self) -> usize {
        each!(self, values => values.len())
    }

    /// Whether there is no value at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The first row without a value.
    fn first_missing(&self) -> Option<usize> {
        each!(self, values => values.iter().position(Option::is_none))
    }

    /// Appends a value that is known to fit.
    fn push(&mut self, value: Value) {
        match (self, value) {
            (Self::Text(values), Value::Text(value)) => values.push(Some(value)),
            (Self::Integer(values), Value::Integer(value)) => values.push(Some(value)),
            (Self::Real(values), Value::Real(value)) => values.push(Some(value)),
            (Self::Flag(values), Value::Flag(value)) => values.push(Some(value)),
            (Self::Samples(values), Value::Samples(value)) => values.push(Some(value)),
            (data, _) => each!(data, values => values.push(None)),
        }
    }
}

/// A table: a schema and the values of its columns, all of one length.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    schema: Schema,
    columns: Vec<Data>,
}

impl Table {
    /// A table without rows.
    pub fn new(schema: Schema) -> Self {
        let columns = schema.columns().iter();
        let columns = columns.map(|column| Data::empty(column.kind)).collect();
        Self { schema, columns }
    }

    /// A table of whole columns, in the order of the schema.
    ///
    /// # Errors
    /// When there are more or fewer columns than in the schema, or one is of another kind or
    /// length, too long, or incomplete without being optional.
    pub fn from_columns(schema: Schema, columns: Vec<Data>) -> Result<Self, Error> {
        if columns.len() != schema.columns().len() {
            return Err(Error::ColumnCount {
                found: columns.len(),
                expected: schema.columns().len(),
            });
        }
        let rows = columns.first().map_or(0, Data::len);
        for (column, data) in schema.columns().iter().zip(&columns) {
            check_column(column, data, rows)?;
        }
        Ok(Self { schema, columns })
    }

    /// Appends a row, or nothing when it does not fit.
    ///
    /// # Errors
    /// When the row has another length than the schema, or a value is of another kind, missing in
    /// a column that is not optional, or too long.
    pub fn push(&mut self, values: Vec<Value>) -> Result<(), Error> {
        let row = self.rows();
        if values.len() != self.columns.len() {
            return Err(Error::RowLength {
                row,
                found: values.len(),
                expected: self.columns.len(),
            });
        }
        for (column, value) in self.schema.columns().iter().zip(&values) {
            check_value(column, value, row)?;
        }
        for (column, value) in self.columns.iter_mut().zip(values) {
            column.push(value);
        }
        Ok(())
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Data::len)
    }

    /// The columns and what holds for the whole table.
    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// The values of every column, in the order of the schema.
    pub fn columns(&self) -> &[Data] {
        &self.columns
    }

    /// The values of the column of that name: `table.values::<f64>("speed_rpm")`.
    ///
    /// # Errors
    /// When there is no such column, or it holds another kind.
    pub fn values<T: Cell>(&self, name: &str) -> Result<&[Option<T>], Error> {
        let data = &self.columns[self.schema.position(name)?];
        T::values(data).ok_or_else(|| other_kind(name, data, T::KIND))
    }
}

fn check_value(column: &Column, value: &Value, row: usize) -> Result<(), Error> {
    let found = match value {
        Value::Missing if column.optional => return Ok(()),
        Value::Missing => return Err(missing(column, row)),
        Value::Samples(samples) if samples.len() > MOST_SAMPLES => {
            return Err(too_many_samples(column, row, samples.len()));
        }
        Value::Text(_) => Kind::Text,
        Value::Integer(_) => Kind::Integer,
        Value::Real(_) => Kind::Real,
        Value::Flag(_) => Kind::Flag,
        Value::Samples(_) => Kind::Samples,
    };
    if found == column.kind {
        return Ok(());
    }
    Err(Error::ValueKind {
        row,
        column: column.name.clone(),
        found,
        expected: column.kind,
    })
}

fn check_column(column: &Column, data: &Data, rows: usize) -> Result<(), Error> {
    if data.kind() != column.kind {
        return Err(other_kind(&column.name, data, column.kind));
    }
    if data.len() != rows {
        return Err(Error::ColumnLength {
            column: column.name.clone(),
            found: data.len(),
            expected: rows,
        });
    }
    if let Data::Samples(values) = data {
        for (row, samples) in values.iter().enumerate() {
            let samples = samples.as_ref().map_or(0, Vec::len);
            if samples > MOST_SAMPLES {
                return Err(too_many_samples(column, row, samples));
            }
        }
    }
    match data.first_missing() {
        Some(row) if !column.optional => Err(missing(column, row)),
        _ => Ok(()),
    }
}

fn other_kind(name: &str, found: &Data, expected: Kind) -> Error {
    Error::ColumnKind {
        column: name.to_owned(),
        found: found.kind(),
        expected,
    }
}

fn missing(column: &Column, row: usize) -> Error {
    Error::MissingValue {
        row,
        column: column.name.clone(),
    }
}

fn too_many_samples(column: &Column, row: usize, samples: usize) -> Error {
    Error::TooManySamples {
        row,
        column: column.name.clone(),
        samples,
        most: MOST_SAMPLES,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn schema() -> Schema {
        Schema::new(vec![
            Column::new("case_id", Kind::Text, "name of the case"),
            Column::new("speed_rpm", Kind::Real, "mean speed").unit("rpm"),
            Column::new("exponent", Kind::Real, "where there is one").optional(),
            Column::new("signal", Kind::Samples, "the recording"),
        ])
        .unwrap()
    }

    #[test]
    fn a_row_that_does_not_fit_leaves_the_table_as_it_was() {
        let mut table = Table::new(schema());
        let row = || {
            vec![
                "a".into(),
                500.0.into(),
                Value::Missing,
                vec![1.0_f32].into(),
            ]
        };
        table.push(row()).unwrap();
        let before = table.clone();

        let mut swapped = row();
        swapped[1] = "500 rpm".into();
        let mut incomplete = row();
        incomplete[3] = Value::Missing;
        let short = vec!["a".into()];
        let messages =
            [swapped, incomplete, short].map(|row| table.push(row).unwrap_err().to_string());
        assert_eq!(
            messages[0],
            "row 1, column `speed_rpm`: found text, expected a real number"
        );
        assert_eq!(
            messages[1],
            "row 1, column `signal`: the value is missing, and the column is not optional"
        );
        assert_eq!(
            messages[2],
            "row 1 has 1 values where the table has 4 columns"
        );
        assert_eq!(table, before);
    }

    #[test]
    fn columns_are_found_by_name_and_kind() {
        let mut table = Table::new(schema());
        table
            .push(vec![
                "a".into(),
                500.0.into(),
                1.5.into(),
                vec![1.0_f32].into(),
            ])
            .unwrap();
        assert_eq!(table.values::<f64>("exponent").unwrap(), [Some(1.5)]);
        assert_eq!(
            table.values::<Vec<f32>>("signal").unwrap(),
            [Some(vec![1.0])]
        );
        let message = |result: Result<&[Option<i64>], Error>| result.unwrap_err().to_string();
        assert_eq!(
            message(table.values("speed")),
            "no column `speed`; there are: case_id, speed_rpm, exponent, signal"
        );
        assert_eq!(
            message(table.values("speed_rpm")),
            "column `speed_rpm` holds a real number, not a whole number"
        );
    }

    #[test]
    fn whole_columns_are_checked_as_rows_are() {
        let text = || Data::Text(vec![Some("a".into())]);
        let real = |values| Data::Real(values);
        let signal = || Data::Samples(vec![Some(vec![0.0])]);
        let fits = vec![text(), real(vec![Some(1.0)]), real(vec![None]), signal()];
        assert_eq!(Table::from_columns(schema(), fits).unwrap().rows(), 1);
        for columns in [
            vec![text()],
            vec![signal(), real(vec![Some(1.0)]), real(vec![None]), signal()],
            vec![text(), real(vec![None]), real(vec![None]), signal()],
            vec![text(), real(vec![Some(1.0); 2]), real(vec![None]), signal()],
        ] {
            Table::from_columns(schema(), columns).unwrap_err();
        }
    }

    #[test]
    fn every_column_has_a_name_of_its_own() {
        let column = |name| Column::new(name, Kind::Flag, "");
        assert!(matches!(
            Schema::new(vec![column("a"), column("b"), column("a")]),
            Err(Error::DuplicateColumn(name)) if name == "a"
        ));
        assert!(matches!(
            Schema::new(vec![column("")]),
            Err(Error::NamelessColumn(0))
        ));
    }
}
