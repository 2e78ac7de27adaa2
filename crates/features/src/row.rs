//! The whole row of a window: what its channels hold, what kind of motion it is, and what is missing.

use crate::{
    Definition, Group, Reason, Window, definitions, features, missing, motion, motion_definitions,
};
pub use chaos::error::FEWEST_SAMPLES;
use recordings::{Column, Kind, Role};

/// What a column of a row holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// A number.
    Number,
    /// Text.
    Text,
}

/// The value of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number, always finite.
    Number(f64),
    /// Text.
    Text(String),
}

/// The column of a feature in a table.
pub fn column((definition, content): (Definition, Content)) -> Column {
    let (kind, meaning) = match content {
        Content::Number => (
            Kind::Real,
            format!("{}: {}", definition.description, definition.formula),
        ),
        Content::Text => (Kind::Text, definition.description),
    };
    let column = Column::new(definition.name, kind, meaning).optional();
    let column = column.role(Role::Feature);
    match definition.unit.as_str() {
        "1" => column,
        unit => column.unit(unit),
    }
}

/// The columns of rows of these channels (names and units): their features, with `motion` the kind of
/// motion, and last `missing`.
pub fn columns<'a>(
    channels: impl IntoIterator<Item = (&'a str, &'a str)>,
    motion: bool,
) -> Vec<(Definition, Content)> {
    let number = |definition| (definition, Content::Number);
    let mut columns: Vec<_> = definitions(channels).into_iter().map(number).collect();
    if motion {
        columns.push(text(
            Group::Motion,
            "regime",
            "Kind of motion: periodic, quasi-periodic, chaotic, stochastic or undecided",
            "crate chaos, module regime",
        ));
        columns.extend(motion_definitions().into_iter().map(number));
        columns.push(text(
            Group::Motion,
            "lyapunov_reason",
            "Why lyapunov_per_s has no value",
            "crate features",
        ));
    }
    columns.push(text(
        Group::Reasons,
        "missing",
        "Why features have no value, as `column: reason`, joined by `; `",
        "crate features",
    ));
    columns
}

fn text(
    group: Group,
    name: &str,
    description: &str,
    source: &'static str,
) -> (Definition, Content) {
    let definition = Definition {
        name: name.to_owned(),
        feature: name.to_owned(),
        group,
        unit: "1".to_owned(),
        description: description.to_owned(),
        formula: "text",
        source,
    };
    (definition, Content::Text)
}

/// The row of a window, in the order of [`columns`].
pub fn row(window: &Window, with_motion: bool) -> Vec<Option<Cell>> {
    row_with_reasons(window, with_motion).0
}

/// The row of a window, and for each of its cells why a number is missing.
pub fn row_with_reasons(
    window: &Window,
    with_motion: bool,
) -> (Vec<Option<Cell>>, Vec<Option<Reason>>) {
    let channels = window.channels.iter();
    let mut defined = definitions(channels.clone().map(|c| (c.name.as_str(), c.unit.as_str())));
    let samples = channels.map(|c| c.samples.len()).min().unwrap_or(0);
    let mut values = if samples < FEWEST_SAMPLES {
        let few = signal::Error::TooFewSamples {
            needed: FEWEST_SAMPLES,
            got: samples,
        };
        vec![Err(Reason::Signal(few)); defined.len()]
    } else {
        features(window)
    };
    let number = |value: &Result<f64, Reason>| value.as_ref().ok().map(|v| Cell::Number(*v));
    let reason = |value: &Result<f64, Reason>| value.as_ref().err().cloned();
    let mut row: Vec<Option<Cell>> = values.iter().map(number).collect();
    let mut reasons: Vec<Option<Reason>> = values.iter().map(reason).collect();
    if with_motion {
        let motion = motion(window);
        reasons.push(motion.regime.as_ref().err().cloned());
        row.push(motion.regime.ok().map(|name| Cell::Text(name.to_owned())));
        row.extend(motion.numbers.iter().map(number));
        reasons.extend(motion.numbers.iter().map(reason));
        let why = motion.numbers.first().and_then(|e| e.as_ref().err());
        row.push(why.map(|reason| Cell::Text(reason.to_string())));
        reasons.push(None);
        defined.extend(motion_definitions());
        values.extend(motion.numbers);
    }
    row.push(missing(&defined, &values).map(Cell::Text));
    reasons.push(None);
    (row, reasons)
}
