//! What repeats every revolution, and what does not.

use crate::angle_resampling::{Revolutions, mean_revolution};
use crate::error::Error;

/// The share of the fluctuation below which a residual is taken for what resampling leaves, as a
/// ratio of mean squares: −80 dB.
pub const RESAMPLING: f64 = 1e-8;

/// A channel split into its crank-angle synchronous average and the residual,
/// x(θ) = x̄(θ mod 2π) + r(θ).
///
/// Source: McFadden 1987, "A revised model for the extraction of periodic waveforms by time domain
/// averaging", Mechanical Systems and Signal Processing 1(1), over equal angles instead of times.
#[derive(Clone, Debug, PartialEq)]
pub struct SynchronousAverage {
    average: Vec<f64>,
    residual: Vec<f64>,
    /// Mean square of the whole about its mean.
    variance: f64,
}

impl SynchronousAverage {
    /// # Errors
    /// Fewer than two revolutions: one is its own average.
    pub fn new(x: &Revolutions) -> Result<Self, Error> {
        if x.count() < 2 {
            return Err(Error::TooFewRevolutions {
                needed: 2,
                got: x.count() as f64,
            });
        }
        let average = mean_revolution(x.samples(), x.points_per_revolution());
        let residual = x
            .iter()
            .flat_map(|revolution| revolution.iter().zip(&average).map(|(x, a)| x - a))
            .collect();
        let n = x.samples().len() as f64;
        let mean = x.samples().iter().sum::<f64>() / n;
        let squares = x.samples().iter().map(|x| (x - mean).powi(2));
        Ok(Self {
            average,
            residual,
            variance: squares.sum::<f64>() / n,
        })
    }

    /// The average, from the angle at which the revolutions start.
    pub fn average(&self) -> &[f64] {
        &self.average
    }

    /// What is left of every point, one revolution after the other.
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// RMS of the residual.
    pub fn residual_rms(&self) -> f64 {
        self.residual_mean_square().sqrt()
    }

    /// Σr⁴/n / (Σr²/n)², not excess: 3 if Gaussian. The residual has no mean.
    ///
    /// # Errors
    /// A residual of less than 1e-4 of the signal's standard deviation, which is what resampling
    /// leaves of a motion that repeats itself.
    pub fn residual_kurtosis(&self) -> Result<f64, Error> {
        let mean_square = self.residual_mean_square();
        if mean_square <= RESAMPLING * self.variance {
            return Err(Error::NoFluctuation);
        }
        let fourth = self.residual.iter().map(|r| r.powi(4)).sum::<f64>();
        Ok(fourth / self.residual.len() as f64 / (mean_square * mean_square))
    }

    /// The share of the mean square about the mean that the average holds. It is 1 − ⟨r²⟩/⟨(x − x̄)²⟩:
    /// 1 for a motion that repeats itself, 1/R on average for noise over R revolutions.
    ///
    /// # Errors
    /// A signal that does not fluctuate.
    pub fn synchronous_share(&self) -> Result<f64, Error> {
        if self.variance <= 0.0 {
            return Err(Error::NoFluctuation);
        }
        Ok((1.0 - self.residual_mean_square() / self.variance).clamp(0.0, 1.0))
    }

    fn residual_mean_square(&self) -> f64 {
        self.residual.iter().map(|r| r * r).sum::<f64>() / self.residual.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle_resampling::AngleGrid;
    use crate::crank_angle::CrankAngle;
    use std::f64::consts::TAU;

    fn split(n: usize, wave: impl Fn(f64) -> f64) -> Result<SynchronousAverage, Error> {
        let angle = CrankAngle::from_speed(n, 256.0, 60.0).unwrap();
        let x: Vec<f64> = (0..n).map(|i| wave(TAU * i as f64 / 256.0)).collect();
        SynchronousAverage::new(&AngleGrid::new(&angle, 256).unwrap().resample(&x)?)
    }

    /// Order 3 repeats; order 5/2 changes its sign every revolution and is the residual. A sine
    /// has kurtosis 3/2.
    #[test]
    fn half_orders_are_the_residual() {
        let split = split(1024, |a| 7.0 + 3.0 * (3.0 * a).cos() + (2.5 * a).sin()).unwrap();
        for (j, mean) in split.average().iter().enumerate() {
            let expected = 7.0 + 3.0 * (3.0 * TAU * j as f64 / 256.0).cos();
            assert!((mean - expected).abs() < 1e-9);
        }
        assert!((split.residual_rms() - 0.5f64.sqrt()).abs() < 1e-9);
        assert!((split.residual_kurtosis().unwrap() - 1.5).abs() < 1e-9);
        assert!((split.synchronous_share().unwrap() - 0.9).abs() < 1e-9);
    }

    #[test]
    fn motion_that_repeats_has_no_residual() {
        let split = split(1024, |a| 3.0 * a.cos()).unwrap();
        assert!((split.synchronous_share().unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(split.residual_kurtosis(), Err(Error::NoFluctuation));
    }

    #[test]
    fn one_revolution_is_refused() {
        let one = split(300, f64::cos);
        assert_eq!(
            one,
            Err(Error::TooFewRevolutions {
                needed: 2,
                got: 1.0
            })
        );
        let still = split(600, |_| 0.0).unwrap();
        assert_eq!(still.synchronous_share(), Err(Error::NoFluctuation));
    }
}
