//! The bifurcation diagrams of the dataset.

use crate::Failure;
use crate::report::dataset::Dataset;
use crate::report::labels::in_words;
use ::report::chaos_page::{Bifurcation, Recorded};
use ::report::text;
use recordings::{Kind, Table};

/// What the page shows of what is recorded: the ending of the column, what it is, its unit.
const SHOWN: [(&str, &str, &str); 2] = [
    ("peak_acceleration_m_s2", "peak acceleration", "m/s²"),
    (
        "crosshead_acceleration_m_s2",
        "acceleration at angle 0",
        "m/s²",
    ),
];

/// The diagrams in the order of their files.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn diagrams(dataset: &Dataset) -> Result<Vec<Bifurcation>, Failure> {
    let paths = dataset.files("bifurcations");
    paths.iter().map(|path| diagram(dataset, path)).collect()
}

fn diagram(dataset: &Dataset, path: &str) -> Result<Bifurcation, Failure> {
    let file = dataset.table(path)?;
    let shown: Vec<(String, &str, &str)> = SHOWN
        .iter()
        .filter_map(|(ending, name, unit)| {
            let columns = file.schema().columns();
            let column = columns
                .iter()
                .find(|column| column.kind == Kind::Samples && column.name.ends_with(ending))?;
            Some((column.name.clone(), *name, *unit))
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
    names.extend(shown.iter().map(|(column, ..)| column.as_str()));
    let table = file.read(&names, 0..file.rows());
    table
        .and_then(|table| of_table(&table, &shown))
        .map_err(|error| dataset.unreadable(path, error))
}

fn of_table(
    table: &Table,
    shown: &[(String, &str, &str)],
) -> Result<Bifurcation, recordings::Error> {
    let first = |name: &str| -> Result<String, recordings::Error> {
        let values = table.values::<String>(name)?;
        Ok(values.iter().flatten().next().cloned().unwrap_or_default())
    };
    let values = table.values::<f64>("value")?;
    let directions = table.values::<String>("direction")?;
    let recorded =
        |(column, name, unit): &(String, &str, &str)| -> Result<Recorded, recordings::Error> {
            let mut recorded = Recorded {
                name: (*name).to_owned(),
                unit: (*unit).to_owned(),
                ..Recorded::default()
            };
            let samples = table.values::<Vec<f32>>(column)?;
            for ((value, direction), samples) in values.iter().zip(directions).zip(samples) {
                let (Some(value), Some(samples)) = (value, samples) else {
                    continue;
                };
                let branch = match direction.as_deref() {
                    Some("down") => &mut recorded.down,
                    _ => &mut recorded.up,
                };
                branch.extend(samples.iter().map(|&y| [*value, f64::from(y)]));
            }
            Ok(recorded)
        };
    let mut reasons: Vec<String> = table
        .values::<String>("reason")?
        .iter()
        .flatten()
        .cloned()
        .collect();
    reasons.retain(|reason| !reason.is_empty());
    reasons.sort();
    reasons.dedup();
    Ok(Bifurcation {
        name: first("bifurcation")?,
        parameter: in_words(&first("path")?),
        unit: text::unit(&first("unit")?),
        quantities: shown.iter().map(recorded).collect::<Result<_, _>>()?,
        reasons,
    })
}
