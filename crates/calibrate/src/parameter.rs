//! What is fitted: paths of the machine file, and the coordinates in which they are searched.

use crate::error::Error;
use input::paths;
use input::unit::{self, Dimension, Measure};
use serde_json::Value;

/// A fitted value of the machine file.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its path in the machine file.
    pub path: String,
    /// Its value there, SI.
    pub nominal: f64,
    /// Its unit; none for a bare number.
    pub dimension: Option<Dimension>,
    /// Whether it is searched on a logarithmic scale.
    pub scale: Scale,
    /// Least and greatest value, SI.
    pub bounds: [f64; 2],
}

/// The scale on which a parameter is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Its logarithm: for positive values that are known to a factor.
    Logarithmic,
    /// The value over its nominal magnitude.
    Linear,
}

/// Without bounds of its own a value is searched from a tenth to ten times the nominal one.
const FACTOR: f64 = 10.0;
/// Lengths, masses and other values that are measured with a rule or a balance are searched from
/// two thirds to one and a half times the nominal one.
const MEASURED_FACTOR: f64 = 1.5;
/// Last keys of paths that are known to a factor only.
const UNCERTAIN: [&str; 7] = [
    "stiffness",
    "damping",
    "depth",
    "coefficient",
    "slip_speed",
    "damping_ratio",
    "clearance",
];

impl Parameter {
    /// The value at `path` of the machine file `tree`, with bounds around its nominal value.
    ///
    /// # Errors
    /// A path that is not there, or whose value is no quantity.
    pub fn of(tree: &Value, path: &str) -> Result<Self, Error> {
        let wrong = |reason: String| Error::Parameter {
            path: path.to_owned(),
            reason,
        };
        let value = paths::get(tree, path)?;
        let value = value.ok_or_else(|| wrong("the machine file has no value there".into()))?;
        let (nominal, dimension) = match value {
            Value::Number(number) => (number.as_f64(), None),
            Value::String(text) => match unit::parse(text) {
                Ok(measure) => (Some(measure.si), Some(measure.dimension)),
                Err(error) => return Err(wrong(format!("'{text}': {error}"))),
            },
            _ => (None, None),
        };
        let nominal = nominal.ok_or_else(|| wrong("its value is no quantity".into()))?;
        let last = path.rsplit('.').next().unwrap_or(path);
        let factor = if UNCERTAIN.contains(&last) {
            FACTOR
        } else {
            MEASURED_FACTOR
        };
        if nominal == 0.0 {
            return Err(wrong(
                "its nominal value is 0, which gives no scale; state a small value".into(),
            ));
        }
        let mut bounds = [nominal / factor, nominal * factor];
        // An exponent of 1 is a limit that no law goes below.
        if last == "exponent" {
            bounds[0] = bounds[0].max(1.01);
        }
        bounds.sort_by(f64::total_cmp);
        Ok(Self {
            path: path.to_owned(),
            nominal,
            dimension,
            scale: if nominal > 0.0 {
                Scale::Logarithmic
            } else {
                Scale::Linear
            },
            bounds,
        })
    }

    /// The coordinate of a value: 0 at the nominal one.
    pub fn coordinate(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Logarithmic => (value / self.nominal).ln(),
            Scale::Linear => (value - self.nominal) / self.nominal.abs(),
        }
    }

    /// The value at a coordinate, SI.
    pub fn value(&self, coordinate: f64) -> f64 {
        match self.scale {
            Scale::Logarithmic => self.nominal * coordinate.exp(),
            Scale::Linear => self.nominal + coordinate * self.nominal.abs(),
        }
    }

    /// The coordinates of the bounds.
    pub fn box_bounds(&self) -> [f64; 2] {
        self.bounds.map(|bound| self.coordinate(bound))
    }

    /// Writes a value into a machine file.
    ///
    /// # Errors
    /// Where the file does not have the path.
    pub fn write(&self, tree: &mut Value, value: f64) -> Result<(), Error> {
        let written = match self.dimension {
            Some(dimension) => Measure {
                si: value,
                dimension,
            }
            .to_string()
            .into(),
            None => Value::from(value),
        };
        Ok(paths::set(tree, &self.path, written)?)
    }
}
