//! Statistics of the samples, independent of their order in time.

use crate::reason::Reason;

/// Sums over the samples x_i, i = 1 .. n, of a window, of which the statistics are made.
///
/// RMS, peak and the factors are of the samples as they are; the mean is not taken off. Skewness
/// and kurtosis are about the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Statistics {
    mean: f64,
    low: f64,
    high: f64,
    mean_square: f64,
    mean_absolute: f64,
    mean_root: f64,
    /// Central moments of order 2, 3 and 4, Σ(x_i − x̄)^m / n.
    moments: [f64; 3],
}

impl Statistics {
    /// # Errors
    /// No samples, or one that is not finite.
    pub(crate) fn new(x: &[f64]) -> Result<Self, Reason> {
        if x.is_empty() {
            return Err(signal::Error::TooFewSamples { needed: 1, got: 0 }.into());
        }
        if let Some(index) = x.iter().position(|x| !x.is_finite()) {
            return Err(signal::Error::NotFinite { index }.into());
        }
        let n = x.len() as f64;
        let mut low = x[0];
        let mut high = x[0];
        let [mut sum, mut squares, mut absolute, mut roots] = [0.0; 4];
        for &x in x {
            low = low.min(x);
            high = high.max(x);
            sum += x;
            squares += x * x;
            absolute += x.abs();
            roots += x.abs().sqrt();
        }
        let mean = sum / n;
        let mut moments = [0.0; 3];
        for x in x {
            let d = x - mean;
            moments[0] += d * d;
            moments[1] += d * d * d;
            moments[2] += d * d * d * d;
        }
        Ok(Self {
            mean,
            low,
            high,
            mean_square: squares / n,
            mean_absolute: absolute / n,
            mean_root: roots / n,
            moments: moments.map(|m| m / n),
        })
    }

    /// Whether all samples are equal.
    pub(crate) fn is_constant(&self) -> bool {
        self.low == self.high
    }

    pub(crate) fn mean(&self) -> f64 {
        self.mean
    }

    pub(crate) fn rms(&self) -> f64 {
        self.mean_square.sqrt()
    }

    pub(crate) fn peak(&self) -> f64 {
        self.high.max(-self.low)
    }

    pub(crate) fn peak_to_peak(&self) -> f64 {
        self.high - self.low
    }

    pub(crate) fn crest_factor(&self) -> Result<f64, Reason> {
        quotient(self.peak(), self.rms())
    }

    pub(crate) fn shape_factor(&self) -> Result<f64, Reason> {
        quotient(self.rms(), self.mean_absolute)
    }

    pub(crate) fn impulse_factor(&self) -> Result<f64, Reason> {
        quotient(self.peak(), self.mean_absolute)
    }

    pub(crate) fn clearance_factor(&self) -> Result<f64, Reason> {
        quotient(self.peak(), self.mean_root * self.mean_root)
    }

    pub(crate) fn skewness(&self) -> Result<f64, Reason> {
        self.standardised(self.moments[1], 1.5)
    }

    pub(crate) fn kurtosis(&self) -> Result<f64, Reason> {
        self.standardised(self.moments[2], 2.0)
    }

    /// `moment` over the variance to the power `exponent`.
    fn standardised(&self, moment: f64, exponent: f64) -> Result<f64, Reason> {
        if self.is_constant() {
            return Err(Reason::Constant);
        }
        quotient(moment, self.moments[0].powf(exponent))
    }
}

/// A quotient of two sizes of the signal; the divisor is 0 only where all samples are.
fn quotient(a: f64, b: f64) -> Result<f64, Reason> {
    if b > 0.0 {
        return Ok(a / b);
    }
    Err(Reason::Constant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, SQRT_2};

    fn all(s: &Statistics) -> [f64; 10] {
        [
            s.mean(),
            s.rms(),
            s.peak(),
            s.peak_to_peak(),
            s.crest_factor().unwrap(),
            s.shape_factor().unwrap(),
            s.impulse_factor().unwrap(),
            s.clearance_factor().unwrap(),
            s.skewness().unwrap(),
            s.kurtosis().unwrap(),
        ]
    }

    fn assert_near(got: [f64; 10], expected: [f64; 10], tolerance: f64) {
        for (i, (g, e)) in got.iter().zip(expected).enumerate() {
            assert!(
                (g - e).abs() <= tolerance * e.abs().max(1.0),
                "{i}: {g} {e}"
            );
        }
    }

    /// `data/reference/signal/make.py`: NumPy and SciPy on the line `input`.
    #[test]
    fn statistics_agree_with_scipy() {
        let text = include_str!("../../../data/reference/signal/reference.csv");
        let line = |name: &str| -> Vec<f64> {
            let line = text.lines().find_map(|l| l.strip_prefix(name)).unwrap();
            line.split(',').map(|n| n.parse().unwrap()).collect()
        };
        let expected = line("statistics,").try_into().unwrap();
        assert_near(
            all(&Statistics::new(&line("input,")).unwrap()),
            expected,
            1e-13,
        );
    }

    /// A sine: ⟨|sin|⟩ = 2/π, ⟨√|sin|⟩ = 0.762759763501, kurtosis 3/2.
    #[test]
    fn statistics_of_a_sine() {
        let n = 100_000;
        let x: Vec<f64> = (0..n)
            .map(|i| 5.0 * (2.0 * PI * f64::from(i) / f64::from(n)).sin())
            .collect();
        let expected = [
            0.0,
            5.0 / SQRT_2,
            5.0,
            10.0,
            SQRT_2,
            PI / (2.0 * SQRT_2),
            PI / 2.0,
            1.0 / 0.762_759_763_501_f64.powi(2),
            0.0,
            1.5,
        ];
        // The sum of roots meets its integral as n^(-3/2), where the sine crosses 0.
        assert_near(all(&Statistics::new(&x).unwrap()), expected, 3e-7);
    }

    #[test]
    fn constant_and_zero_signals_have_no_shape() {
        let constant = Statistics::new(&[0.1; 7]).unwrap();
        assert_eq!(constant.kurtosis(), Err(Reason::Constant));
        assert_eq!(constant.skewness(), Err(Reason::Constant));
        assert!((constant.crest_factor().unwrap() - 1.0).abs() < 1e-15);
        let zero = Statistics::new(&[0.0; 7]).unwrap();
        assert_eq!(zero.crest_factor(), Err(Reason::Constant));
        assert_eq!(zero.clearance_factor(), Err(Reason::Constant));
    }
}
