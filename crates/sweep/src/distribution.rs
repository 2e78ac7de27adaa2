//! Distributions by their inverse: a number in (0, 1) in, a value out, so that any design feeds
//! any distribution.

use scalar::elementary::{exp, ln};

use crate::normal::quantile;

/// A distribution of a number, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Every value between two equally likely.
    Uniform {
        /// Smallest value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// The logarithm is uniform: every ratio equally likely.
    LogUniform {
        /// Smallest value, above 0.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// Gauss's, of the number or of its logarithm.
    Gaussian(Gaussian),
}

/// Gauss's distribution of a number or of its logarithm, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gaussian {
    /// The number is normal.
    Normal {
        /// Mean value.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
    /// The logarithm is normal.
    LogNormal {
        /// Half of the values are smaller; above 0.
        median: f64,
        /// 68 % of the values lie between median / factor and median × factor; at least 1.
        factor: f64,
    },
}

impl Gaussian {
    /// The value that `deviate` of a standard normal distribution stands for.
    pub fn value(&self, deviate: f64) -> f64 {
        match *self {
            Gaussian::Normal { mean, deviation } => mean + deviation * deviate,
            Gaussian::LogNormal { median, factor } => median * exp(ln(factor) * deviate),
        }
    }
}

impl Distribution {
    /// The value below which the share `unit` of all values lies; `unit` must be in (0, 1).
    pub fn quantile(&self, unit: f64) -> f64 {
        match *self {
            Distribution::Uniform { low, high } => low + unit * (high - low),
            Distribution::LogUniform { low, high } => low * exp(unit * ln(high / low)),
            Distribution::Gaussian(gaussian) => gaussian.value(quantile(unit)),
        }
    }
}

/// Which of several choices with these weights the number `unit` in (0, 1) picks. The weights
/// must be finite, not negative, and not all 0; only their ratios count.
pub fn choose(weights: &[f64], unit: f64) -> usize {
    let mut left = unit * weights.iter().sum::<f64>();
    for (choice, &weight) in weights.iter().enumerate() {
        if left < weight {
            return choice;
        }
        left -= weight;
    }
    // Rounding of the sum: the last choice that can be picked at all.
    weights.iter().rposition(|&w| w > 0.0).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_at_known_points() {
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        let (low, high) = (2.0, 8.0);
        close(Distribution::Uniform { low, high }.quantile(0.25), 3.5);
        close(Distribution::LogUniform { low, high }.quantile(0.5), 4.0);
        close(
            Distribution::LogUniform { low, high }.quantile(0.25),
            8_f64.sqrt(),
        );
        // Φ(1) and Φ(2), from tables with 16 digits.
        let (one, two) = (0.841_344_746_068_542_9, 0.977_249_868_051_820_8);
        let (mean, deviation) = (-3.0, 0.5);
        let normal = Distribution::Gaussian(Gaussian::Normal { mean, deviation });
        close(normal.quantile(one), -2.5);
        let (median, factor) = (5.0, 1.2);
        let lognormal = Distribution::Gaussian(Gaussian::LogNormal { median, factor });
        close(lognormal.quantile(0.5), 5.0);
        close(lognormal.quantile(one), 6.0);
        close(lognormal.quantile(two), 7.2);
        close(lognormal.quantile(1.0 - one), 5.0 / 1.2);
    }

    #[test]
    fn choices_come_by_weight() {
        let weights = [1.0, 0.0, 3.0];
        assert_eq!(choose(&weights, 1e-16), 0);
        assert_eq!(choose(&weights, 0.2499), 0);
        assert_eq!(choose(&weights, 0.2501), 2);
        assert_eq!(choose(&weights, 1.0 - 1e-16), 2);
        assert_eq!(choose(&[0.1; 3], 1.0 - 1e-16), 2);
        assert_eq!(choose(&[0.5, 0.0], 1.0), 0);
    }
}
