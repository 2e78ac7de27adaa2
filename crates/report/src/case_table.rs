//! The cases of a dataset as the script of its page gets them: a table to sort and filter, and a picture of each case
//! small enough that thousands stand in one file.

use base64::prelude::{BASE64_STANDARD, Engine};
use serde::Serialize;
use std::collections::BTreeMap;

/// The cases, each in the same place of all lists.
#[derive(Clone, Debug, Default, Serialize)]
pub struct CaseTable {
    /// How many cases the dataset has; of very many some are listed, evenly over all.
    pub all: usize,
    /// The name of each.
    pub ids: Vec<String>,
    /// The classes that there are.
    pub classes: Vec<CaseClass>,
    /// Which of these each case is of.
    pub class: Vec<usize>,
    /// The splits that there are.
    pub splits: Vec<String>,
    /// Which of these each case is in.
    pub split: Vec<usize>,
    /// Numbers: what varies, and features of the first window.
    pub numbers: Vec<CaseNumbers>,
    /// Parameters that are text and vary.
    pub texts: Vec<CaseTexts>,
    /// What is doubtful about a case, without the advice.
    pub warnings: BTreeMap<String, Vec<String>>,
    /// The command that runs a case alone, from the dataset's folder; `CASE` stands for its name.
    pub command: String,
    /// Every so many cases one has curves.
    pub step: usize,
    /// What was recorded.
    pub channels: Vec<CaseChannel>,
}

/// A class of cases.
#[derive(Clone, Debug, Serialize)]
pub struct CaseClass {
    /// Its label.
    pub label: String,
    /// The label in words.
    pub name: String,
    /// Its colour on all pages, `#rrggbb`.
    pub colour: String,
}

/// A column of numbers.
#[derive(Clone, Debug, Serialize)]
pub struct CaseNumbers {
    /// What it is.
    pub name: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// To five significant digits; null where a value is missing.
    pub values: Vec<f64>,
}

/// A column of texts.
#[derive(Clone, Debug, Serialize)]
pub struct CaseTexts {
    /// What it is.
    pub name: String,
    /// The text of each case.
    pub values: Vec<String>,
}

/// A channel of the first window of each case that has curves.
#[derive(Clone, Debug, Serialize)]
pub struct CaseChannel {
    /// Its name in words.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The last whole revolution from crank angle 0, in equal parts: of accelerations the lowest and the highest value in
    /// each, in the order in which they come, of pressures the value between these.
    pub revolution: Curves,
    /// The velocity at these values, m/s; of accelerations that judge faults.
    pub velocity: Option<Curves>,
    /// Decimal logarithm of the amplitude at orders 1, 2, … of the crank's speed; of accelerations.
    pub orders: Option<Curves>,
    /// Amplitude of the envelope in the most impulsive band at orders 1, 2, …; of accelerations with these features.
    pub envelope: Option<Curves>,
    /// The volume of the chamber in the middle of each part of the revolution, dm³; of a chamber's pressure.
    pub volume: Vec<f64>,
}

/// A curve of equally many values for each case, to 1/255 of what it spans.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Curves {
    /// Values of a curve.
    pub count: usize,
    /// The lowest of each case.
    pub low: Vec<f64>,
    /// The highest of each case.
    pub high: Vec<f64>,
    /// A byte for each value from 0, the lowest, to 255, the highest, in base 64.
    pub levels: String,
}

impl Curves {
    /// Curves of the same length; one that is empty or not finite lies at zero.
    pub fn pack<'a>(curves: impl Iterator<Item = &'a Vec<f64>> + Clone) -> Self {
        let count = curves.clone().map(Vec::len).max().unwrap_or(0);
        let mut packed = Self {
            count,
            ..Self::default()
        };
        let mut levels = Vec::new();
        for curve in curves {
            let finite = || curve.iter().copied().filter(|value| value.is_finite());
            let (low, high) = finite()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                    (low.min(v), high.max(v))
                });
            let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
            let scale = if high > low {
                255.0 / (high - low)
            } else {
                0.0
            };
            let level = |value: &f64| ((value - low) * scale).round() as u8;
            levels.extend(curve.iter().map(level));
            levels.resize(levels.len() + count - curve.len(), 0);
            packed.low.push(rounded(low));
            packed.high.push(rounded(high));
        }
        packed.levels = BASE64_STANDARD.encode(levels);
        packed
    }

    /// The same curves in another unit, of which one is `factor` times the former.
    pub fn scaled(mut self, factor: f64) -> Self {
        for value in self.low.iter_mut().chain(&mut self.high) {
            *value = rounded(*value * factor);
        }
        self
    }
}

/// To five significant digits, so that it is short as text.
pub(crate) fn rounded(value: f64) -> f64 {
    if !value.is_finite() || value == 0.0 {
        return value;
    }
    format!("{value:.4e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_kept_to_a_255th_of_what_it_spans() {
        let curves = [vec![-1.0, 0.0, 4.1], vec![2.0, 2.0, 2.0], vec![]];
        let packed = Curves::pack(curves.iter());
        assert_eq!((packed.count, &packed.low), (3, &vec![-1.0, 2.0, 0.0]));
        assert_eq!(packed.high, [4.1, 2.0, 0.0]);
        let levels = BASE64_STANDARD.decode(packed.levels).unwrap();
        assert_eq!(levels, [0, 50, 255, 0, 0, 0, 0, 0, 0]);
        assert_eq!(
            [rounded(0.123_456_7), rounded(-98_765.4)],
            [0.123_46, -98_765.0]
        );
    }
}
