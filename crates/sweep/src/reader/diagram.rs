//! The bifurcation diagrams of a dataset.

use super::{Dataset, Error, Subset};
use recordings::{Column, Kind, Table};

/// A bifurcation diagram.
pub struct Diagram {
    /// Its name in the sweep file.
    pub name: String,
    /// The path of the machine file that varies.
    pub path: String,
    /// Its unit.
    pub unit: String,
    /// The values of the parameter, in the order of the table.
    pub points: Vec<Point>,
    /// What is recorded once a revolution, of what was asked for.
    pub quantities: Vec<Quantity>,
}

/// One value of the parameter.
pub struct Point {
    /// The value.
    pub value: Option<f64>,
    /// Where the parameter comes from.
    pub direction: Direction,
    /// Why nothing is recorded; empty where something is.
    pub reason: String,
}

/// How the parameter changes from run to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// It rises.
    Up,
    /// It falls.
    Down,
}

/// One recorded quantity.
pub struct Quantity {
    /// Its column.
    pub column: String,
    /// Its values at each point.
    pub samples: Vec<Option<Vec<f32>>>,
}

impl Dataset {
    /// The diagrams in the order of their files, with the first quantity whose column ends with each of
    /// `endings`.
    ///
    /// # Errors
    /// A table that cannot be read.
    pub fn diagrams(&self, endings: &[&str]) -> Result<Vec<Diagram>, Error> {
        let files = &self.files;
        let paths = files.paths(Subset::Bifurcations);
        let diagram = |path: &String| {
            let file = files.open(path)?;
            let columns = file.schema().columns();
            let quantities: Vec<&str> = endings
                .iter()
                .filter_map(|ending| {
                    let is = |c: &&Column| c.kind == Kind::Samples && c.name.ends_with(ending);
                    Some(columns.iter().find(is)?.name.as_str())
                })
                .collect();
            let mut names = vec![
                "bifurcation",
                "path",
                "unit",
                "direction",
                "value",
                "reason",
            ];
            names.extend(&quantities);
            let rows = 0..file.rows();
            files.read(path, &file, &names, rows, |table| {
                of_table(table, &quantities)
            })
        };
        paths.iter().map(diagram).collect()
    }
}

fn of_table(table: &Table, quantities: &[&str]) -> Result<Diagram, recordings::Error> {
    let first = |name: &str| -> Result<String, recordings::Error> {
        let values = table.values::<String>(name)?;
        Ok(values.iter().flatten().next().cloned().unwrap_or_default())
    };
    let values = table.values::<f64>("value")?.iter();
    let directions = table.values::<String>("direction")?;
    let reasons = table.values::<String>("reason")?;
    let points = values.zip(directions).zip(reasons);
    let points = points.map(|((value, direction), reason)| Point {
        value: *value,
        direction: match direction.as_deref() {
            Some("down") => Direction::Down,
            _ => Direction::Up,
        },
        reason: reason.clone().unwrap_or_default(),
    });
    let quantity = |column: &&str| -> Result<Quantity, recordings::Error> {
        Ok(Quantity {
            column: (*column).to_owned(),
            samples: table.values::<Vec<f32>>(column)?.to_vec(),
        })
    };
    Ok(Diagram {
        name: first("bifurcation")?,
        path: first("path")?,
        unit: first("unit")?,
        points: points.collect(),
        quantities: quantities.iter().map(quantity).collect::<Result<_, _>>()?,
    })
}
