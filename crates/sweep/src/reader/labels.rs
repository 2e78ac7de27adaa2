//! The columns that describe a case: clearances, operating point, parameters.

use crate::Plan;
use crate::dataset::prefixed;

/// A column of numbers that describe a case, and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Its name in the tables.
    pub column: String,
    /// What it is.
    pub meaning: Meaning,
    /// Its unit, as the tables write it; empty for none.
    pub unit: String,
    /// The value of each window; NaN where one is missing.
    pub values: Vec<f64>,
}

/// What a number says about a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// Clearance of the joint of this name.
    Clearance(String),
    /// Speed of the crank.
    Speed,
    /// A pressure at the cylinder of a throw, whose name is empty in a machine of one.
    Pressure {
        /// Name of the throw.
        throw: String,
        /// Which of the two.
        side: Side,
    },
    /// The value at this path of the machine file.
    Parameter(String),
}

/// A side of a cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Where the gas comes from.
    Suction,
    /// Where it goes to.
    Discharge,
}

impl Side {
    /// `suction` or `discharge`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Suction => "suction",
            Self::Discharge => "discharge",
        }
    }
}

/// A parameter that is text, and its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// Its column in the tables.
    pub column: String,
    /// Its path in the machine file.
    pub path: String,
    /// The value of each window.
    pub values: Vec<String>,
}

impl Label {
    /// The joint whose clearance it is.
    pub fn joint(&self) -> Option<&str> {
        match &self.meaning {
            Meaning::Clearance(joint) => Some(joint),
            _ => None,
        }
    }
}

/// The numbers that the tables of `plan` say about a case, in their order, without values.
pub(super) fn numbers(plan: &Plan) -> Vec<Label> {
    let label = |column: String, meaning: Meaning, unit: &str| Label {
        column,
        meaning,
        unit: unit.to_owned(),
        values: Vec::new(),
    };
    let clearances = plan.joints.iter().map(|joint| {
        let column = format!("clearance_{}_m", joint.name);
        label(column, Meaning::Clearance(joint.name.clone()), "m")
    });
    let mut labels: Vec<Label> = clearances.collect();
    labels.push(label("speed_rpm".to_owned(), Meaning::Speed, "rpm"));
    for throw in plan.throws() {
        for side in [Side::Suction, Side::Discharge] {
            let column = prefixed(throw, &format!("{}_pressure_pa", side.name()));
            let throw = throw.clone();
            labels.push(label(column, Meaning::Pressure { throw, side }, "Pa"));
        }
    }
    let numbers = plan.parameters.iter().filter(|p| p.is_number);
    labels.extend(numbers.map(|parameter| {
        let unit = parameter.unit.as_deref().filter(|unit| *unit != "%");
        let meaning = Meaning::Parameter(parameter.path.clone());
        label(parameter.column.clone(), meaning, unit.unwrap_or_default())
    }));
    labels
}

/// The parameters of `plan` that are text, in their order, without values.
pub(super) fn texts(plan: &Plan) -> Vec<Text> {
    let texts = plan.parameters.iter().filter(|p| !p.is_number);
    texts
        .map(|parameter| Text {
            column: parameter.column.clone(),
            path: parameter.path.clone(),
            values: Vec::new(),
        })
        .collect()
}
