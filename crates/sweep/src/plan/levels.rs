//! The values of an axis that is gone through.

use input::Error;
use serde_json::Value;

use super::sampler::same_dimension;
use crate::digits::rounded;
use crate::distribution::Distribution;
use crate::sweep_file::{self, Amount, Spacing, Values};

/// Values in order. Steps are computed one by one, so that a million of them take no memory.
#[derive(Clone, Debug)]
pub(super) enum Levels {
    /// As they stand in the file.
    List(Vec<Value>),
    /// Equal steps from the first to the last, each as the decimal that a list would have.
    Steps {
        ends: [Amount; 2],
        between: Distribution,
        count: u32,
    },
}

impl Levels {
    /// The values in the file.
    pub(super) fn new(levels: &sweep_file::Levels) -> Result<Self, Error> {
        let range = match levels {
            Values::One(value) => return Ok(Self::List(vec![value.clone()])),
            Values::List(values) => return Ok(Self::List(values.clone())),
            Values::Rule(range) => range,
        };
        let ends = [range.from, range.to];
        same_dimension(&ends)?;
        let [low, high] = ends.map(|end| end.si);
        let between = match range.spacing {
            Spacing::Linear => Distribution::Uniform { low, high },
            Spacing::Log if low > 0.0 && high > 0.0 => Distribution::LogUniform { low, high },
            Spacing::Log => return Err(Error::unexpected("spacing", "log", "ends above 0 for it")),
        };
        let count = range.count.get();
        Ok(Self::Steps {
            ends,
            between,
            count,
        })
    }

    /// How many there are.
    pub(super) fn len(&self) -> u64 {
        match self {
            Levels::List(values) => values.len() as u64,
            Levels::Steps { count, .. } => (*count).into(),
        }
    }

    /// Value `level`, which must be below [`Levels::len`].
    pub(super) fn at(&self, level: usize) -> Value {
        match self {
            Levels::List(values) => values[level].clone(),
            Levels::Steps {
                ends: [first, last],
                between,
                count,
            } => {
                let steps = *count as usize - 1;
                let amount = match level {
                    0 => *first,
                    level if level == steps => *last,
                    level => Amount {
                        si: rounded(between.quantile(level as f64 / steps as f64), f64::DIGITS),
                        ..*first
                    },
                };
                amount.to_value()
            }
        }
    }

    /// Values that show what the axis goes through: all of a list, the ends of a range.
    pub(super) fn representatives(&self) -> Vec<Value> {
        match self {
            Levels::List(values) => values.clone(),
            Levels::Steps { ends, .. } => ends.iter().map(|end| end.to_value()).collect(),
        }
    }

    /// The key of value `level` below that of its axis; empty if the values are not listed.
    pub(super) fn key(&self, axis: &str, level: usize) -> String {
        match self {
            Levels::List(values) if values.len() > 1 => format!("{axis}.{level}"),
            _ => axis.to_owned(),
        }
    }
}
