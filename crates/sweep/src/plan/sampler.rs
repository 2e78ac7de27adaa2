//! A value that is drawn, made ready: a number in (0, 1) in, a value for the machine file out.

use input::Error;
use input::quantity::{Kind, Speed};
use input::unit::Dimension;
use serde_json::Value;

use super::case::rpm;
use crate::distribution::{Distribution, Gaussian, choose};
use crate::sweep_file::{self, Amount, Draw, Spread, Values};

/// Something to draw from.
#[derive(Clone, Debug)]
pub(super) enum Sampler {
    /// One of several values.
    Choice {
        values: Vec<Value>,
        weights: Vec<f64>,
    },
    /// A number.
    Number {
        distribution: Distribution,
        scale: Scale,
    },
}

/// What makes a number a value of the machine file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    dimension: Option<Dimension>,
    /// Least and greatest value.
    range: [f64; 2],
}

impl Scale {
    /// The value of `si`; of the nearer end of the range where it is beyond.
    pub(super) fn value(&self, si: f64) -> Value {
        let [low, high] = self.range;
        let (si, dimension) = (si.clamp(low, high), self.dimension);
        Amount { si, dimension }.to_value()
    }
}

impl Sampler {
    /// What `draw` says; `given` is the machine file's value, which some distributions refer to.
    pub(super) fn new(draw: &Draw, given: Option<&Value>) -> Result<Self, Error> {
        match draw {
            Values::One(value) => equally_likely(std::slice::from_ref(value)),
            Values::List(values) => equally_likely(values),
            Values::Rule(spread) => of_spread(spread, given),
        }
    }

    /// Values that show what is drawn: all that can be of a list, two of a distribution.
    pub(super) fn representatives(&self) -> Vec<Value> {
        match self {
            Sampler::Choice { values, weights } => {
                let choices = values.iter().zip(weights);
                let possible = choices.filter(|(_, weight)| **weight > 0.0);
                possible.map(|(value, _)| value.clone()).collect()
            }
            Sampler::Number { .. } => [0.25, 0.75].map(|unit| self.draw(unit)).into(),
        }
    }

    /// The value that `unit` in (0, 1) stands for.
    pub(super) fn draw(&self, unit: f64) -> Value {
        match self {
            Sampler::Choice { values, weights } => values[choose(weights, unit)].clone(),
            Sampler::Number {
                distribution,
                scale,
            } => scale.value(distribution.quantile(unit)),
        }
    }
}

fn equally_likely(values: &[Value]) -> Result<Sampler, Error> {
    if values.is_empty() {
        return Err(Error::unexpected("", "an empty list", "at least one value"));
    }
    Ok(Sampler::Choice {
        values: values.to_vec(),
        weights: vec![1.0; values.len()],
    })
}

fn of_spread(spread: &Spread, given: Option<&Value>) -> Result<Sampler, Error> {
    let number = |name: &str, distribution, amounts: &[Amount]| {
        same_dimension(amounts).map_err(|e| e.under(name))?;
        Ok(Sampler::Number {
            distribution,
            scale: Scale {
                dimension: amounts[0].dimension,
                range: [f64::NEG_INFINITY, f64::INFINITY],
            },
        })
    };
    let bell = |spread| {
        let (gaussian, scale) = gaussian(&spread, given)?;
        Ok(Sampler::Number {
            distribution: Distribution::Gaussian(gaussian),
            scale,
        })
    };
    match spread {
        Spread::Uniform(ends) => {
            let [low, high] = ascending(ends).map_err(|e| e.under("uniform"))?;
            number("uniform", Distribution::Uniform { low, high }, ends)
        }
        Spread::LogUniform(ends) => {
            let [low, high] = ascending(ends).map_err(|e| e.under("log_uniform"))?;
            positive(&ends[0]).map_err(|e| e.under("log_uniform.0"))?;
            number("log_uniform", Distribution::LogUniform { low, high }, ends)
        }
        Spread::Normal(normal) => bell(sweep_file::Gaussian::Normal(*normal)),
        Spread::Lognormal(lognormal) => bell(sweep_file::Gaussian::Lognormal(*lognormal)),
        Spread::Choice(choice) => {
            let weights: Vec<f64> = choice.weights.iter().map(|w| w.get()).collect();
            if weights.len() != choice.values.len() || weights.iter().sum::<f64>() <= 0.0 {
                let found = format_args!("{} weights", weights.len());
                let expected = format_args!("one per value, {}, not all 0", choice.values.len());
                return Err(Error::unexpected("choice.weights", found, expected));
            }
            Ok(Sampler::Choice {
                values: choice.values.clone(),
                weights,
            })
        }
    }
}

/// The distribution that `spread` says; `given` is the machine file's value, about which it lies
/// where it has no middle of its own.
pub(super) fn gaussian(
    spread: &sweep_file::Gaussian,
    given: Option<&Value>,
) -> Result<(Gaussian, Scale), Error> {
    let given = || {
        let amount = given.and_then(Amount::from_value);
        amount.ok_or_else(|| {
            Error::unexpected("", "no number in the machine file", "one to vary about")
        })
    };
    let scale = |name: &str, amounts: &[Amount], range: Option<[Amount; 2]>| {
        same_dimension(amounts).map_err(|e| e.under(name))?;
        let within = range.map_or(Ok([f64::NEG_INFINITY, f64::INFINITY]), |range| {
            same_dimension(&[amounts[0], range[0], range[1]])?;
            ascending(&range)
        });
        Ok(Scale {
            dimension: amounts[0].dimension,
            range: within.map_err(|e| e.under("range").under(name))?,
        })
    };
    match spread {
        sweep_file::Gaussian::Normal(normal) => {
            let mean = normal.mean.map_or_else(given, Ok)?;
            if normal.deviation.si < 0.0 {
                let found = text(&normal.deviation);
                return Err(Error::unexpected("normal.deviation", found, "0 or more"));
            }
            let gaussian = Gaussian::Normal {
                mean: mean.si,
                deviation: normal.deviation.si,
            };
            let amounts = [mean, normal.deviation];
            Ok((gaussian, scale("normal", &amounts, normal.range)?))
        }
        sweep_file::Gaussian::Lognormal(lognormal) => {
            let median = lognormal.median.map_or_else(given, Ok)?;
            positive(&median).map_err(|e| e.under("lognormal.median"))?;
            let gaussian = Gaussian::LogNormal {
                median: median.si,
                factor: lognormal.factor.get(),
            };
            Ok((gaussian, scale("lognormal", &[median], lognormal.range)?))
        }
    }
}

fn ascending(ends: &[Amount; 2]) -> Result<[f64; 2], Error> {
    same_dimension(ends)?;
    let [low, high] = ends.map(|end| end.si);
    if low > high {
        let expected = format_args!("at least the lower end, {}", text(&ends[0]));
        return Err(Error::clash("1", expected));
    }
    Ok([low, high])
}

fn positive(amount: &Amount) -> Result<(), Error> {
    if amount.si > 0.0 {
        Ok(())
    } else {
        Err(Error::unexpected("", text(amount), "more than 0"))
    }
}

/// Checks that amounts can be compared.
pub(super) fn same_dimension(amounts: &[Amount]) -> Result<(), Error> {
    match amounts.iter().find(|a| a.dimension != amounts[0].dimension) {
        None => Ok(()),
        Some(other) => {
            let found = format_args!("{} beside {}", text(other), text(&amounts[0]));
            Err(Error::unexpected("", found, "values of one kind"))
        }
    }
}

/// An amount as messages show it.
pub(super) fn text(amount: &Amount) -> String {
    if amount.dimension == Some(Speed::DIMENSION) {
        // Nobody writes rad/s.
        return format!("{} rpm", rpm(amount.si));
    }
    match amount.to_value() {
        Value::String(text) => text,
        number => number.to_string(),
    }
}
