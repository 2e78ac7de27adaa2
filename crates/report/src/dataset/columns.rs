//! The columns of the tables, features named once for all channels and orders.

use crate::{Column, Error};
use sweep::reader::{Dataset, Subset};

/// The columns of a file of either table. Of features there are hundreds: those of the first
/// channel stand for all, and a numbered row of them is one line.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn columns(dataset: &Dataset) -> Result<Vec<Column>, Error> {
    let signals = of_table(dataset, Subset::Signals)?;
    let mut features = of_table(dataset, Subset::Features)?;
    let labels: Vec<String> = signals.iter().map(|column| column.name.clone()).collect();
    let first = dataset.plan.channels().into_iter().next();
    let channel = match (dataset.sensors.channels(), first) {
        ([channel, ..], _) => channel.clone(),
        ([], Some((name, _))) => name,
        ([], None) => String::new(),
    };
    let shown = |name: &str| name.starts_with(&format!("{channel}.")) || !is_feature(dataset, name);
    features.retain(|column| !labels.contains(&column.name) && shown(&column.name));
    Ok(signals.into_iter().chain(numbered(features)).collect())
}

/// Whether the column is a feature of some channel.
fn is_feature(dataset: &Dataset, column: &str) -> bool {
    let channels = dataset.plan.channels();
    let definitions =
        features::definitions(channels.iter().map(|(name, unit)| (name.as_str(), *unit)));
    definitions
        .iter()
        .any(|definition| definition.name == column)
}

/// The columns of the first file of a table.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn of_table(dataset: &Dataset, table: Subset) -> Result<Vec<Column>, Error> {
    let columns = dataset.columns(table)?.into_iter();
    Ok(columns
        .map(|column| Column {
            table: table.name().to_owned(),
            name: column.name,
            kind: column.kind.to_string(),
            unit: text::unit(column.unit.as_deref().unwrap_or_default()),
            meaning: column.description,
        })
        .collect())
}

/// The columns with every run of names that differ in digits alone (`order_01`, `order_02`, …) as
/// one.
fn numbered(columns: Vec<Column>) -> Vec<Column> {
    let mut kept: Vec<Column> = Vec::new();
    let mut last = String::new();
    for column in columns {
        let pattern: String = column.name.replace(|c: char| c.is_ascii_digit(), "#");
        match kept.last_mut() {
            Some(before) if pattern == last => {
                if !before.name.contains(" … ") {
                    before.meaning += "; and so on";
                }
                let first = before.name.split(" … ").next().unwrap_or_default();
                before.name = format!("{first} … {}", column.name);
            }
            _ => kept.push(column),
        }
        last = pattern;
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbered_columns_are_one_line() {
        let column = |name: &str| Column {
            table: "features".to_owned(),
            name: name.to_owned(),
            kind: String::new(),
            unit: String::new(),
            meaning: format!("that is {name}"),
        };
        let names = [
            "x.rms_m_s2",
            "x.order_01_m_s2",
            "x.order_02_m_s2",
            "x.order_03_m_s2",
        ];
        let lines = numbered(names.map(column).into());
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[0].meaning, "that is x.rms_m_s2");
        assert_eq!(lines[1].name, "x.order_01_m_s2 … x.order_03_m_s2");
        assert_eq!(lines[1].meaning, "that is x.order_01_m_s2; and so on");
    }
}
