//! A pair of axes and what is drawn on it.

use super::colour::Colour;
use super::series::{Layer, Series};

/// One pair of axes and what is drawn on them.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// Heading of the panel; empty for none.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is drawn, the first at the back.
    pub series: Vec<Series>,
    /// One unit is as long on x as on y, and the plotting area is a square.
    pub equal_axes: bool,
    /// Circles drawn under the series, for instance the clearance circle of a bearing.
    pub circles: Vec<Circle>,
    /// Fields of a map, drawn under the series.
    pub fields: Vec<Field>,
    /// A remark in the middle of the panel, for a panel that has nothing to show.
    pub note: String,
}

/// What an axis measures.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// Quantity with its unit in parentheses: `acceleration (m/s²)`.
    pub label: String,
    /// How values are placed.
    pub scale: Scale,
    /// Lowest and highest value shown; taken from the data where it is missing.
    pub range: Option<(f64, f64)>,
    /// What stands at 0, 1, 2, … in place of numbers; none on an axis of numbers.
    pub names: Vec<String>,
    /// Where the speed of the crank stands on the axis of a spectrum: 1 on one of orders, its frequency on
    /// one of frequencies. Cursors at its multiples can then be shown.
    pub fundamental: Option<f64>,
}

/// How values are placed along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// In proportion.
    #[default]
    Linear,
    /// In proportion to the logarithm. What is zero or negative is drawn at the lower edge.
    Log,
    /// In proportion, in degrees, with ticks at fractions of a revolution.
    Degrees,
}

/// A square of a map, one unit wide and high, with a few letters in it.
#[derive(Clone, Debug)]
pub struct Field {
    /// Its middle.
    pub at: [f64; 2],
    /// Its fill, a [`Colour::Tint`].
    pub fill: Colour,
    /// What stands in it.
    pub letters: String,
    /// When it is shown.
    pub layer: Layer,
}

/// A circle in the units of the axes.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    /// Centre.
    pub centre: [f64; 2],
    /// Radius.
    pub radius: f64,
}

impl Axis {
    /// A linear axis over the range of the data.
    pub fn linear(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ..Self::default()
        }
    }

    /// A logarithmic axis over the range of the data.
    pub fn log(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            scale: Scale::Log,
            ..Self::default()
        }
    }

    /// A linear axis of orders of the crank speed.
    pub fn orders() -> Self {
        Self {
            fundamental: Some(1.0),
            ..Self::linear("order of crank speed")
        }
    }

    /// An axis of names, at 0, 1, 2, …
    pub fn named(label: impl Into<String>, names: Vec<String>) -> Self {
        Self {
            label: label.into(),
            range: Some((-0.5, names.len().max(1) as f64 - 0.5)),
            names,
            ..Self::default()
        }
    }

    /// The crank angle over one revolution, in degrees.
    pub fn crank_angle() -> Self {
        Self {
            label: "crank angle (°)".to_owned(),
            scale: Scale::Degrees,
            range: Some((0.0, 360.0)),
            ..Self::default()
        }
    }
}
