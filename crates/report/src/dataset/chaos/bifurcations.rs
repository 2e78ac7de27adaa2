//! The bifurcation diagrams of the dataset.

use crate::chaos_page::{Bifurcation, Recorded};
use crate::dataset::words;
use crate::{Error, text};
use std::collections::BTreeSet;
use sweep::reader::{Dataset, Diagram, Direction, Quantity};

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
pub(super) fn diagrams(dataset: &Dataset) -> Result<Vec<Bifurcation>, Error> {
    let diagrams = dataset.diagrams(&SHOWN.map(|(ending, ..)| ending))?;
    Ok(diagrams.iter().map(diagram).collect())
}

fn diagram(diagram: &Diagram) -> Bifurcation {
    let quantities = diagram.quantities.iter();
    let reasons = diagram.points.iter().map(|point| point.reason.as_str());
    let reasons: BTreeSet<&str> = reasons.filter(|reason| !reason.is_empty()).collect();
    Bifurcation {
        name: diagram.name.clone(),
        parameter: words::of_path(&diagram.path),
        unit: text::unit(&diagram.unit),
        quantities: quantities
            .filter_map(|quantity| recorded(diagram, quantity))
            .collect(),
        reasons: reasons.into_iter().map(str::to_owned).collect(),
    }
}

fn recorded(diagram: &Diagram, quantity: &Quantity) -> Option<Recorded> {
    let mut shown = SHOWN.iter();
    let (_, name, unit) = shown.find(|(ending, ..)| quantity.column.ends_with(ending))?;
    let mut recorded = Recorded {
        name: (*name).to_owned(),
        unit: (*unit).to_owned(),
        ..Recorded::default()
    };
    for (point, samples) in diagram.points.iter().zip(&quantity.samples) {
        let (Some(value), Some(samples)) = (point.value, samples) else {
            continue;
        };
        let branch = match point.direction {
            Direction::Up => &mut recorded.up,
            Direction::Down => &mut recorded.down,
        };
        branch.extend(samples.iter().map(|&y| [value, f64::from(y)]));
    }
    Some(recorded)
}
