//! The crank angle of every sample: unwrapped and freed of the encoder's steps.

use crate::error::{Error, positive};
use scalar::Scalar;
use std::f64::consts::{PI, TAU};

/// One step of a 16-bit encoder, rad.
const ENCODER_STEP: f64 = TAU / 65536.0;

/// The angle is smoothed over this much to either side, rad (2°). Fluctuations of speed at the
/// low orders that a flywheel lets through change by less than 1e-6 rad. The error of a 16-bit
/// encoder shrinks with the root of the samples in the span.
const SMOOTHING: f64 = 2.0 * PI / 180.0;

/// Crank angle at each sample, unwrapped and strictly increasing.
#[derive(Clone, Debug, PartialEq)]
pub struct CrankAngle {
    angle: Vec<f64>,
}

impl CrankAngle {
    /// From encoder readings in [0, 2π), rad, one per sample.
    ///
    /// The readings are unwrapped ([`unwrap`]) and smoothed by a quadratic fitted to 2° on either
    /// side of each sample (Savitzky and Golay 1964). At speeds where several samples share one
    /// reading this also separates them.
    ///
    /// # Errors
    /// Those of [`unwrap`], fewer than four samples, or a shaft that stands still.
    pub fn from_encoder(wrapped: &[f64]) -> Result<Self, Error> {
        let raw = unwrap(wrapped)?;
        check_length(raw.len())?;
        let per_sample = (raw[raw.len() - 1] - raw[0]) / (raw.len() - 1) as f64;
        // A shaft that hardly turns gives an infinite quotient; the cast then saturates.
        let half = (SMOOTHING / per_sample.max(0.0)).round() as usize;
        let angle = smooth(&raw, half.min((raw.len() - 1) / 2));
        match angle.windows(2).position(|pair| pair[1] <= pair[0]) {
            Some(i) => Err(Error::AngleNotIncreasing {
                index: i + 1,
                step_rad: angle[i + 1] - angle[i],
            }),
            None => Ok(Self { angle }),
        }
    }

    /// From a constant speed, starting at angle 0: without an encoder the phase is unknown.
    ///
    /// # Errors
    /// Fewer than four samples, a rate or speed that is not positive, or less than two samples a
    /// revolution.
    pub fn from_speed(samples: usize, sample_rate: f64, speed_rpm: f64) -> Result<Self, Error> {
        check_length(samples)?;
        positive("sample rate, Hz", sample_rate)?;
        positive("speed, rpm", speed_rpm)?;
        let step = TAU * speed_rpm / 60.0 / sample_rate;
        if step > PI {
            return Err(Error::OutOfRange {
                what: "speed, rpm",
                value: speed_rpm,
                allowed: "at most half a revolution per sample",
            });
        }
        Ok(Self {
            angle: (0..samples).map(|i| step * i as f64).collect(),
        })
    }

    /// From the readings of an encoder where there is one, otherwise from a constant speed.
    ///
    /// # Errors
    /// Those of [`Self::from_encoder`] and [`Self::from_speed`].
    pub fn recorded(
        encoder: Option<&[f64]>,
        samples: usize,
        sample_rate: f64,
        speed_rpm: f64,
    ) -> Result<Self, Error> {
        match encoder {
            Some(readings) => Self::from_encoder(readings),
            None => Self::from_speed(samples, sample_rate, speed_rpm),
        }
    }

    /// The angles, rad; four at least.
    pub fn angles(&self) -> &[f64] {
        &self.angle
    }

    /// Samples per revolution, on average.
    pub fn samples_per_revolution(&self) -> f64 {
        let last = self.angle.len() - 1;
        TAU * last as f64 / (self.angle[last] - self.angle[0])
    }

    /// Revolutions that the samples cover, one sample interval each.
    pub fn revolutions(&self) -> f64 {
        self.angle.len() as f64 / self.samples_per_revolution()
    }

    /// The sample index, with its fraction, at which the crank stands at `angle`. Cubic
    /// interpolation of the inverse map. Beyond the ends the speed is taken as constant.
    pub fn position(&self, angle: f64) -> f64 {
        let above = self.angle.partition_point(|&x| x <= angle);
        self.position_before(above, angle)
    }

    /// The [`position`](Self::position) of each of these angles, none of which is below the one before.
    pub fn positions(&self, angles: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut above = 0;
        let position = |angle| {
            while self.angle.get(above).is_some_and(|x| *x <= angle) {
                above += 1;
            }
            self.position_before(above, angle)
        };
        angles.map(position).collect()
    }

    /// The position of an angle that is below that of sample `above` and of no sample before it.
    fn position_before(&self, above: usize, angle: f64) -> f64 {
        let a = &self.angle;
        let last = a.len() - 1;
        if above == 0 {
            return (angle - a[0]) / (a[1] - a[0]);
        }
        if above > last {
            return last as f64 + (angle - a[last]) / (a[last] - a[last - 1]);
        }
        let first = above.saturating_sub(2).min(last - 3);
        let t: [f64; 4] = std::array::from_fn(|m| a[first + m] - angle);
        let weight = |m: usize| -> f64 {
            let product =
                |of: &dyn Fn(usize) -> f64| -> f64 { (0..4).filter(|&l| l != m).map(of).product() };
            product(&|l| t[l]) / product(&|l| t[l] - t[m])
        };
        first as f64 + weight(1) + 2.0 * weight(2) + 3.0 * weight(3)
    }
}

/// Unwraps crank angles in [0, 2π), rad: whole revolutions are added so that the angle grows.
///
/// A reading may repeat, or fall by one step of a 16-bit encoder; the result does the same.
///
/// # Errors
/// A reading that is not finite or outside the range, one that falls further, and one that jumps
/// by more than half a revolution (which looks the same). The sample is named.
pub fn unwrap(wrapped: &[f64]) -> Result<Vec<f64>, Error> {
    let mut unwrapped = Vec::with_capacity(wrapped.len());
    let mut angle = 0.0;
    let mut before = 0.0;
    for (index, &reading) in wrapped.iter().enumerate() {
        if !reading.is_finite() {
            return Err(Error::NotFinite { index });
        }
        if !(-ENCODER_STEP..=TAU + ENCODER_STEP).contains(&reading) {
            return Err(Error::OutOfRange {
                what: "crank angle, rad",
                value: reading,
                allowed: "in [0, 2π)",
            });
        }
        let change = reading - before;
        let step_rad = change - TAU * (change / TAU).round();
        if index == 0 {
            angle = reading;
        } else if step_rad < -1.5 * ENCODER_STEP {
            return Err(Error::AngleNotIncreasing { index, step_rad });
        } else {
            angle += step_rad;
        }
        before = reading;
        unwrapped.push(angle);
    }
    Ok(unwrapped)
}

/// Whether readings in [0, 2π), rad, one per sample, fall on the whole, each step taken the shorter way round.
/// Those of an encoder whose direction is reversed do.
pub fn runs_backwards(wrapped: &[f64]) -> bool {
    let step = |pair: &[f64]| {
        let change = pair[1] - pair[0];
        change - TAU * (change / TAU).round()
    };
    wrapped.windows(2).map(step).sum::<f64>() < 0.0
}

fn check_length(got: usize) -> Result<(), Error> {
    if got < 4 {
        return Err(Error::TooFewSamples { needed: 4, got });
    }
    Ok(())
}

/// Each value replaced by that of the quadratic fitted to it and `half` neighbours on either
/// side (Savitzky and Golay 1964). Near the ends, by that of the first or last such quadratic. `y` has 2·`half` + 1 values
/// or more.
fn smooth(y: &[f64], half: usize) -> Vec<f64> {
    if half == 0 {
        return y.to_vec();
    }
    let mut smoothed = y.to_vec();
    let last = y.len() - half;
    smooth_between_ends(y, half, &mut smoothed[half..last]);
    let ends = [(0..half, half), (last..y.len(), last - 1)];
    for (places, centre) in ends {
        let [c0, c1, c2] = fit_quadratic(&y[centre - half..=centre + half]);
        for i in places {
            let j = i as f64 - centre as f64;
            smoothed[i] = c0 + j * (c1 + j * c2);
        }
    }
    smoothed
}

/// Values that are smoothed at a time, which stay in the nearest cache.
const SMOOTHED_AT_A_TIME: usize = 512;

/// The values of `y` that have `half` neighbours on either side. What neighbours differ by is added, each with the weight that
/// it has in the fitted quadratic's value in the middle: sums of small numbers keep their digits.
fn smooth_between_ends(y: &[f64], half: usize, smoothed: &mut [f64]) {
    let sums = Sums::over(half);
    f64::vectorised(
        #[inline(always)]
        || {
            let mut first = half;
            for smoothed in smoothed.chunks_mut(SMOOTHED_AT_A_TIME) {
                let here = &y[first..];
                for j in 1..=half {
                    let weight = (sums.s4 - sums.s2 * (j * j) as f64) / sums.determinant();
                    let sides = y[first - j..].iter().zip(&y[first + j..]);
                    for ((value, middle), (before, after)) in
                        smoothed.iter_mut().zip(here).zip(sides)
                    {
                        *value += weight * ((before - middle) + (after - middle));
                    }
                }
                first += smoothed.len();
            }
        },
    );
}

/// Sums over j = −h ..= h.
struct Sums {
    /// Of 1.
    n: f64,
    /// Of j².
    s2: f64,
    /// Of j⁴.
    s4: f64,
}

impl Sums {
    fn over(half: usize) -> Self {
        let h = half as f64;
        let n = 2.0 * h + 1.0;
        let s2 = h * (h + 1.0) * n / 3.0;
        Self {
            n,
            s2,
            s4: s2 * (3.0 * h * h + 3.0 * h - 1.0) / 5.0,
        }
    }

    fn determinant(&self) -> f64 {
        self.n * self.s4 - self.s2 * self.s2
    }
}

/// Least-squares c₀ + c₁j + c₂j² of an odd number of values at j = −h ..= h.
fn fit_quadratic(y: &[f64]) -> [f64; 3] {
    let half = y.len() / 2;
    let sums = Sums::over(half);
    let [mut y0, mut y1, mut y2] = [0.0; 3];
    for (i, value) in y.iter().enumerate() {
        let j = i as f64 - half as f64;
        // The middle value is taken off: sums of small numbers keep their digits.
        let value = value - y[half];
        y0 += value;
        y1 += j * value;
        y2 += j * j * value;
    }
    [
        y[half] + (sums.s4 * y0 - sums.s2 * y2) / sums.determinant(),
        y1 / sums.s2,
        (sums.n * y2 - sums.s2 * y0) / sums.determinant(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// θ(t) of a shaft whose speed fluctuates at order 2, read by a 16-bit encoder.
    fn shaft(i: usize, samples_per_revolution: f64) -> f64 {
        let even = TAU * i as f64 / samples_per_revolution + 0.3;
        even + 0.02 * (2.0 * even).sin()
    }

    fn encoder(angle: f64) -> f64 {
        ((angle / ENCODER_STEP).floor() * ENCODER_STEP).rem_euclid(TAU)
    }

    #[test]
    fn quantised_angle_is_recovered_at_any_rate() {
        for samples_per_revolution in [60.3, 1200.0, 40_000.0, 300_000.0] {
            let n = (2.2 * samples_per_revolution) as usize;
            let truth: Vec<f64> = (0..n).map(|i| shaft(i, samples_per_revolution)).collect();
            let readings: Vec<f64> = truth.iter().map(|a| encoder(*a)).collect();
            let angle = CrankAngle::from_encoder(&readings).unwrap();
            // The encoder rounds down: half a step is its constant error.
            let worst = angle.angles().iter().zip(&truth);
            let worst = worst.fold(0.0, |w: f64, (a, b)| {
                w.max((a - b + 0.5 * ENCODER_STEP).abs())
            });
            assert!(
                worst < 0.6 * ENCODER_STEP,
                "{samples_per_revolution}: {worst:e}"
            );
            assert!(angle.angles().windows(2).all(|pair| pair[0] < pair[1]));
        }
    }

    #[test]
    fn smoothing_leaves_an_exact_angle_within_a_microradian() {
        let truth: Vec<f64> = (0..3000).map(|i| shaft(i, 1200.0)).collect();
        let readings: Vec<f64> = truth.iter().map(|a| a.rem_euclid(TAU)).collect();
        let angle = CrankAngle::from_encoder(&readings).unwrap();
        for (a, b) in angle.angles().iter().zip(&truth) {
            assert!((a - b).abs() < 1e-6);
        }
    }

    #[test]
    fn smoothing_keeps_a_quadratic_and_is_its_fit_elsewhere() {
        let parabola: Vec<f64> = (0..1300).map(|i| 1e-6 * f64::from(i * i) + 0.1).collect();
        for (a, b) in smooth(&parabola, 9).iter().zip(&parabola) {
            assert!((a - b).abs() < 1e-12);
        }
        let bent: Vec<f64> = (0..1300).map(|i| (0.3 * f64::from(i)).sin()).collect();
        let smoothed = smooth(&bent, 4);
        for i in [4, 515, 516, 517, 1295] {
            let [middle, ..] = fit_quadratic(&bent[i - 4..=i + 4]);
            assert!((smoothed[i] - middle).abs() < 1e-14);
        }
    }

    #[test]
    fn position_inverts_the_map() {
        let readings: Vec<f64> = (0..3000)
            .map(|i| shaft(i, 1200.0).rem_euclid(TAU))
            .collect();
        let angle = CrankAngle::from_encoder(&readings).unwrap();
        for i in [0, 1, 7, 1500, 2998, 2999] {
            assert!((angle.position(angle.angles()[i]) - i as f64).abs() < 1e-8);
        }
        let between = || (-50..3100).map(|i| 1e-3 + TAU * f64::from(i) / 1200.0);
        let one_by_one: Vec<f64> = between().map(|a| angle.position(a)).collect();
        assert_eq!(angle.positions(between()), one_by_one);
        let even = CrankAngle::from_speed(100, 100.0, 60.0).unwrap();
        assert!((even.position(-0.5 * TAU / 100.0) + 0.5).abs() < 1e-12);
        assert!((even.position(TAU) - 100.0).abs() < 1e-9);
        assert!((even.revolutions() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_reversed_encoder_is_distinguished_from_one_that_slips() {
        let forward: Vec<f64> = (0..1000).map(|i| shaft(i, 90.0).rem_euclid(TAU)).collect();
        let backward: Vec<f64> = forward.iter().map(|a| (TAU - a).rem_euclid(TAU)).collect();
        let mut slips = forward.clone();
        slips[500] -= 0.3;
        assert!(!runs_backwards(&forward) && !runs_backwards(&slips));
        assert!(runs_backwards(&backward));
    }

    #[test]
    fn backward_steps_jumps_and_bad_readings_are_named() {
        let backwards = unwrap(&[6.2, 0.1, 0.3, 0.2]);
        assert!(matches!(
            backwards,
            Err(Error::AngleNotIncreasing { index: 3, .. })
        ));
        let jump = unwrap(&[0.0, 0.1, 3.5, 3.6]);
        assert!(matches!(
            jump,
            Err(Error::AngleNotIncreasing { index: 2, .. })
        ));
        assert_eq!(unwrap(&[0.0, f64::NAN]), Err(Error::NotFinite { index: 1 }));
        assert!(matches!(unwrap(&[0.0, 7.0]), Err(Error::OutOfRange { .. })));
        let jitter = unwrap(&[1.0, 1.0 - ENCODER_STEP, 1.0 + ENCODER_STEP]).unwrap();
        assert!((jitter[2] - 1.0 - ENCODER_STEP).abs() < 1e-15);
        let still = CrankAngle::from_encoder(&[1.0; 50]);
        assert!(matches!(still, Err(Error::AngleNotIncreasing { .. })));
        assert!(CrankAngle::from_encoder(&[0.0, 1.0, 2.0]).is_err());
        assert!(CrankAngle::from_speed(10, 1.0, 31.0).is_err());
        assert!(CrankAngle::from_speed(10, 1.0, -3.0).is_err());
    }
}
