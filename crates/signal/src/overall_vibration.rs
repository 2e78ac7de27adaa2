//! Overall vibration: RMS of acceleration, velocity and displacement in a band of frequencies.

use crate::amplitude_spectrum::{check, sides};
use crate::error::Error;
use std::f64::consts::TAU;

/// Share of a band's edge by which a line may miss it and still be in the band: a line that lies on the
/// edge must not depend on rounding.
const AT_THE_EDGE: f64 = 1e-6;

/// RMS values of a vibration in a band of frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverallVibration {
    /// Of the acceleration, m/s².
    pub acceleration: f64,
    /// Of the velocity, m/s.
    pub velocity: f64,
    /// Of the displacement, m.
    pub displacement: f64,
}

impl OverallVibration {
    /// Of an acceleration at equal times over whole revolutions, m/s². `sample_rate` and `band` (lowest
    /// and highest frequency, both included) in Hz.
    ///
    /// The acceleration is integrated in the frequency domain: with the amplitude A_k at the frequency
    /// f_k, the velocity has A_k/(2πf_k) there, the displacement A_k/(2πf_k)². The mean squares over the
    /// band add up (Parseval). No window is applied: over whole revolutions the lines of the shaft stand
    /// on the bins, and nothing leaks into the low ones, which the integration amplifies.
    ///
    /// # Errors
    /// Fewer than two samples, one that is not finite, a sample rate that is not positive, or a band
    /// that does not begin above 0.
    pub fn new(x: &[f64], sample_rate: f64, band: [f64; 2]) -> Result<Self, Error> {
        Self::integrated(x, sample_rate, band, 0)
    }

    /// The same of a velocity, m/s: its acceleration has 2πf_k times its amplitude, its displacement that over 2πf_k.
    ///
    /// # Errors
    /// As [`OverallVibration::new`].
    pub fn of_velocity(x: &[f64], sample_rate: f64, band: [f64; 2]) -> Result<Self, Error> {
        Self::integrated(x, sample_rate, band, 1)
    }

    /// Of a signal that is an acceleration integrated so many times.
    fn integrated(x: &[f64], sample_rate: f64, band: [f64; 2], times: i32) -> Result<Self, Error> {
        check(x, sample_rate)?;
        let [low, high] = band;
        if !(low > 0.0 && low < high) {
            return Err(Error::OutOfRange {
                what: "lowest frequency of a band, Hz",
                value: low,
                allowed: "above 0 and below the highest",
            });
        }
        let n = x.len();
        let mean = x.iter().sum::<f64>() / n as f64;
        let mut work: Vec<f64> = x.iter().map(|x| x - mean).collect();
        let spectrum = fourier::forward(&mut work);
        let scale = 1.0 / (n as f64 * n as f64);
        let within = low * (1.0 - AT_THE_EDGE)..=high * (1.0 + AT_THE_EDGE);
        let mut squares = [0.0; 3];
        for (k, c) in spectrum.iter().enumerate() {
            let frequency = k as f64 * sample_rate / n as f64;
            if !within.contains(&frequency) {
                continue;
            }
            let integral = (TAU * frequency).powi(-2);
            let mut mean_square = sides(k, n) * scale * c.norm_sqr();
            mean_square *= (TAU * frequency).powi(2 * times);
            for square in &mut squares {
                *square += mean_square;
                mean_square *= integral;
            }
        }
        let [acceleration, velocity, displacement] = squares.map(f64::sqrt);
        Ok(Self {
            acceleration,
            velocity,
            displacement,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle_resampling::AngleGrid;
    use crate::crank_angle::CrankAngle;
    use std::f64::consts::SQRT_2;

    const BAND: [f64; 2] = [2.0, 1000.0];

    fn near(found: f64, expected: f64, within: f64) {
        assert!(
            (found / expected - 1.0).abs() < within,
            "{found} for {expected}"
        );
    }

    #[test]
    fn sines_have_their_closed_forms_and_what_is_outside_does_not_count() {
        // 25 Hz and 1000 Hz (on the edge) count; 1 Hz, 1500 Hz and the mean do not.
        let value = |i: usize| {
            let t = i as f64 / 5000.0;
            let sine = |amplitude: f64, f: f64| amplitude * (TAU * f * t + 0.3).sin();
            7.0 + sine(10.0, 25.0) + sine(3.0, 1000.0) + sine(5.0, 1.0) + sine(5.0, 1500.0)
        };
        let x: Vec<f64> = (0..10_000).map(value).collect();
        let found = OverallVibration::new(&x, 5000.0, BAND).unwrap();
        let [slow, fast] = [TAU * 25.0, TAU * 1000.0];
        near(found.acceleration, 10.0_f64.hypot(3.0) / SQRT_2, 1e-9);
        near(
            found.velocity,
            (10.0 / slow).hypot(3.0 / fast) / SQRT_2,
            1e-9,
        );
        let displacement = (10.0 / slow.powi(2)).hypot(3.0 / fast.powi(2));
        near(found.displacement, displacement / SQRT_2, 1e-9);
        // As velocities the same sines have these.
        let found = OverallVibration::of_velocity(&x, 5000.0, BAND).unwrap();
        near(
            found.acceleration,
            (10.0 * slow).hypot(3.0 * fast) / SQRT_2,
            1e-9,
        );
        near(found.velocity, 10.0_f64.hypot(3.0) / SQRT_2, 1e-9);
        near(
            found.displacement,
            (10.0 / slow).hypot(3.0 / fast) / SQRT_2,
            1e-9,
        );
    }

    #[test]
    fn whole_revolutions_are_cut_at_equal_times_whatever_the_record_begins_with() {
        // 8 1/3 Hz at 10 kHz: 1200 samples per revolution, 12.4 revolutions recorded.
        let speed = 500.0 / 60.0;
        let value = |i: usize| 40.0 * (TAU * speed * i as f64 / 1e4 + 1.0).cos();
        let x: Vec<f64> = (0..14_880).map(value).collect();
        let crank = CrankAngle::from_speed(x.len(), 1e4, 500.0).unwrap();
        let grid = AngleGrid::new(&crank, 2048).unwrap();
        let (x, rate) = grid.at_equal_times(&x, 1e4).unwrap();
        let found = OverallVibration::new(&x, rate, BAND).unwrap();
        let omega = TAU * speed;
        near(found.velocity, 40.0 / omega / SQRT_2, 1e-6);
        near(found.displacement, 40.0 / omega.powi(2) / SQRT_2, 1e-6);
    }

    #[test]
    fn a_band_from_zero_is_refused() {
        assert!(OverallVibration::new(&[1.0, 2.0], 10.0, [0.0, 4.0]).is_err());
        assert!(OverallVibration::new(&[1.0, 2.0], 10.0, [f64::NAN, 4.0]).is_err());
        assert!(OverallVibration::new(&[1.0], 10.0, BAND).is_err());
    }
}
