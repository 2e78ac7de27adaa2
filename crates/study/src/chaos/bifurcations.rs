//! The bifurcation diagrams of the dataset.

use crate::Error;
use crate::words;
use std::collections::{BTreeMap, BTreeSet};
use sweep::reader::{Dataset, Diagram, Direction, Quantity};

/// How the motion changes along a path of the machine file.
#[derive(Clone, Debug, Default)]
pub struct Bifurcation {
    /// Its name in the sweep file.
    pub name: String,
    /// What varies, in words.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// What is recorded once a revolution.
    pub quantities: Vec<Recorded>,
    /// The motion at each value, once a revolution; empty where its velocity is not recorded.
    pub sections: Vec<Section>,
    /// Why values have no points, each reason once.
    pub reasons: Vec<String>,
}

/// The motion at a value of the parameter of a bifurcation diagram, when the crank passes angle 0.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct Section {
    /// The value.
    pub value: f64,
    /// Velocity in m/s and acceleration in m/s² of each revolution, the parameter rising.
    pub up: Vec<[f64; 2]>,
    /// The same with the parameter falling.
    pub down: Vec<[f64; 2]>,
}

/// One quantity of a bifurcation diagram.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    /// What it is.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// (parameter, quantity) of each revolution, the parameter rising from run to run.
    pub up: Vec<[f64; 2]>,
    /// The same with the parameter falling.
    pub down: Vec<[f64; 2]>,
}

/// What the page shows of what is recorded: the ending of the column, what it is, its unit.
const SHOWN: [(&str, &str, &str); 2] = [
    ("peak_acceleration_m_s2", "peak acceleration", "m/s²"),
    (
        "crosshead_acceleration_m_s2",
        "acceleration at angle 0",
        "m/s²",
    ),
];

/// With the acceleration at angle 0 it makes the section of a motion.
const VELOCITY: &str = "crosshead_velocity_m_s";

/// The diagrams in the order of their files.
///
/// # Errors
/// A table that cannot be read.
pub fn diagrams(dataset: &Dataset) -> Result<Vec<Bifurcation>, Error> {
    let endings = SHOWN.map(|(ending, ..)| ending);
    let diagrams = dataset.diagrams(&[&endings[..], &[VELOCITY]].concat())?;
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
        sections: sections(diagram),
        reasons: reasons.into_iter().map(str::to_owned).collect(),
    }
}

fn sections(diagram: &Diagram) -> Vec<Section> {
    let samples = |ending: &str| {
        let of_ending = |quantity: &&Quantity| quantity.column.ends_with(ending);
        diagram
            .quantities
            .iter()
            .find(of_ending)
            .map(|quantity| &quantity.samples)
    };
    let (Some(velocities), Some(accelerations)) = (samples(VELOCITY), samples(SHOWN[1].0)) else {
        return Vec::new();
    };
    let mut sections: BTreeMap<u64, Section> = BTreeMap::new();
    let rows = diagram.points.iter().zip(velocities).zip(accelerations);
    for ((point, velocities), accelerations) in rows {
        let (Some(value), Some(v), Some(a)) = (point.value, velocities, accelerations) else {
            continue;
        };
        let new = Section {
            value,
            ..Section::default()
        };
        let section = sections.entry(value.to_bits()).or_insert(new);
        let motion = v.iter().zip(a).map(|(v, a)| [f64::from(*v), f64::from(*a)]);
        match point.direction {
            Direction::Up => section.up.extend(motion),
            Direction::Down => section.down.extend(motion),
        }
    }
    sections.into_values().collect()
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
