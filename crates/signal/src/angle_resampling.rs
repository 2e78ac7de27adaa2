//! From samples at equal times to samples at equal crank angles.

use crate::crank_angle::CrankAngle;
use crate::decimate::Decimator;
use crate::error::{Error, positive};
use crate::interpolation::interpolate;
use crate::kaiser::{HALF_WIDTH, PASS_BAND};
use fourier::Complex64;
use std::f64::consts::TAU;
use std::ops::Range;

/// Where, between the samples, the crank passes equally spaced angles. There are `points_per_revolution`
/// of them, at multiples of 2π/points, over as many whole revolutions as the recording holds.
///
/// The revolutions are taken from the middle of the recording. They may overhang its ends by up
/// to one sample interval, so that a record of n whole revolutions gives n.
///
/// One grid serves all channels of a recording.
#[derive(Clone, Debug)]
pub struct AngleGrid {
    /// Sample indices of the grid, which is finer than asked for by the decimator's factor and
    /// extends beyond both ends by its half length.
    positions: Vec<f64>,
    decimator: Decimator,
    factor: usize,
    samples: usize,
    samples_per_revolution: f64,
    points_per_revolution: usize,
    /// Multiple of 2π/points at which the first revolution starts.
    first_point: usize,
    /// Sample indices at which the first revolution starts and the last ends.
    ends: [f64; 2],
}

impl AngleGrid {
    /// The grid of a recording.
    ///
    /// With fewer points than the recording has samples per revolution, channels are resampled
    /// more finely first and then decimated ([`Decimator`]). Thus nothing aliases into the
    /// orders up to 0.4 of the points.
    ///
    /// # Errors
    /// Fewer than 32 points, or less than one revolution.
    pub fn new(angle: &CrankAngle, points_per_revolution: usize) -> Result<Self, Error> {
        let n = checked(points_per_revolution)?;
        let samples = angle.angles().len();
        let step = TAU / n as f64;
        let points = points_within_one_interval(angle, step);
        let revolutions = (points.end - points.start) / n as i64;
        if revolutions < 1 {
            return Err(Error::TooFewRevolutions {
                needed: 1,
                got: angle.revolutions(),
            });
        }
        let count = revolutions * n as i64;
        let middle = 0.5 * (angle.angles()[0] + angle.angles()[samples - 1]) / step;
        let centred = (middle - 0.5 * (count - 1) as f64).round() as i64;
        let first = centred.clamp(points.start, points.end - count);
        Self::over(angle, n, first, count)
    }

    /// The grid of so many whole revolutions that begin at a multiple of 2π/points: the first that is `start` modulo a
    /// revolution and at least a revolution after the first sample.
    ///
    /// The recording covers all that its filters reach, so that the bounds of resampling hold for every point: up to
    /// 0.4 of the points (or of the samples per revolution, if they are fewer) an order passes within 1e-4, and of
    /// those that would alias below that less than 1e-4 is left.
    ///
    /// # Errors
    /// Fewer than 32 points, and a recording that does not reach a revolution beyond either end.
    pub fn from_start(
        angle: &CrankAngle,
        points_per_revolution: usize,
        start: usize,
        revolutions: usize,
    ) -> Result<Self, Error> {
        let n = checked(points_per_revolution)?;
        let step = TAU / n as f64;
        let a = angle.angles();
        // The encoder's steps must not decide on a whole revolution.
        let begin = (a[0] / step - 0.5).ceil() as i64 + n as i64;
        let first = begin + (start as i64 - begin).rem_euclid(n as i64);
        let grid = Self::over(angle, n, first, (revolutions * n) as i64)?;
        let reach = HALF_WIDTH as f64;
        let [low, high] = [grid.positions[0], grid.positions[grid.positions.len() - 1]];
        if low < reach || high > a.len() as f64 - 1.0 - reach {
            return Err(Error::TooFewRevolutions {
                needed: revolutions + 3,
                got: angle.revolutions(),
            });
        }
        Ok(grid)
    }

    fn over(angle: &CrankAngle, n: usize, first: i64, count: i64) -> Result<Self, Error> {
        let step = TAU / n as f64;
        // Up to 1 % more samples than points is as good as none: rounding must not decide.
        let excess = angle.samples_per_revolution() / (1.01 * n as f64);
        let factor = excess.ceil().max(1.0) as usize;
        let decimator = Decimator::new(factor)?;
        let fine = |i: usize| {
            let offset = (i as f64 - decimator.half_length() as f64) / factor as f64;
            (first as f64 + offset) * step
        };
        let count_of_fine = decimator.input_length(count as usize);
        Ok(Self {
            positions: angle.positions((0..count_of_fine).map(fine)),
            decimator,
            factor,
            samples: angle.angles().len(),
            samples_per_revolution: angle.samples_per_revolution(),
            points_per_revolution: n,
            first_point: first.rem_euclid(n as i64) as usize,
            ends: [first, first + count].map(|point| angle.position(point as f64 * step)),
        })
    }

    /// The grid that is as fine as the recording: its points per revolution are a power of two, and not
    /// below the samples per revolution (but for the 1 % that [`AngleGrid::new`] allows).
    ///
    /// # Errors
    /// Less than one revolution.
    pub fn as_fine_as_recorded(angle: &CrankAngle) -> Result<Self, Error> {
        let per_revolution = (angle.samples_per_revolution() / 1.01).ceil() as usize;
        // Below 64 low orders would not fit; above 65 536 there is more detail than an encoder's.
        let points = per_revolution.clamp(64, 1 << 16).next_power_of_two();
        Self::new(angle, points)
    }

    /// Sample indices of the recording, with their fractions, at which the first revolution starts and the last ends.
    pub fn ends(&self) -> [f64; 2] {
        self.ends
    }

    /// The highest order that resampling leaves unchanged (within 1e-4): 0.8 of half the samples,
    /// or of half the points, per revolution, whichever are fewer.
    pub fn highest_order(&self) -> usize {
        let fewest = (self.points_per_revolution as f64).min(self.samples_per_revolution);
        (PASS_BAND * 0.5 * fewest) as usize
    }

    /// Samples of the recording per revolution, on average.
    pub fn samples_per_revolution(&self) -> f64 {
        self.samples_per_revolution
    }

    /// Resamples a channel of the recording, one value per sample in order of time, by windowed-sinc interpolation.
    ///
    /// # Errors
    /// A channel whose length is not that of the crank angle.
    pub fn resample(&self, x: &[f64]) -> Result<Revolutions, Error> {
        if x.len() != self.samples {
            return Err(Error::LengthMismatch {
                what: "samples of a channel beside its crank angle",
                got: x.len(),
                expected: self.samples,
            });
        }
        let fine = interpolate(x, self.positions.iter().copied());
        Ok(Revolutions {
            samples: if self.factor == 1 {
                fine
            } else {
                self.decimator.apply(&fine)
            },
            points_per_revolution: self.points_per_revolution,
            first_point: self.first_point,
        })
    }

    /// The whole revolutions of a channel at equal times, and their sample rate, Hz: that of the recording,
    /// raised so that the samples divide the time of the revolutions.
    ///
    /// # Errors
    /// A channel whose length is not that of the crank angle, a sample rate that is not positive.
    pub fn at_equal_times(&self, x: &[f64], sample_rate: f64) -> Result<(Vec<f64>, f64), Error> {
        positive("sample rate, Hz", sample_rate)?;
        if x.len() != self.samples {
            return Err(Error::LengthMismatch {
                what: "samples of a channel beside its crank angle",
                got: x.len(),
                expected: self.samples,
            });
        }
        let [start, end] = self.ends;
        let length = end - start;
        // Within rounding of a whole number it is that number.
        let count = (length - 1e-6).ceil().max(2.0);
        let step = length / count;
        let positions = (0..count as usize).map(|i| start + i as f64 * step);
        Ok((interpolate(x, positions), sample_rate / step))
    }

    /// Time that the crank takes around each point, from half a step before to half a step after,
    /// s. `sample_rate` in Hz.
    ///
    /// # Errors
    /// A sample rate that is not positive.
    pub fn intervals(&self, sample_rate: f64) -> Result<Vec<f64>, Error> {
        positive("sample rate, Hz", sample_rate)?;
        let lead = self.decimator.half_length();
        let inner = &self.positions[lead..self.positions.len() - lead];
        let at: Vec<f64> = inner.iter().step_by(self.factor).copied().collect();
        let last = at.len() - 1;
        let interval = |i: usize| {
            let [low, high] = [i.saturating_sub(1), (i + 1).min(last)];
            (at[high] - at[low]) / ((high - low) as f64 * sample_rate)
        };
        Ok((0..at.len()).map(interval).collect())
    }
}

fn checked(points_per_revolution: usize) -> Result<usize, Error> {
    if points_per_revolution < 32 {
        return Err(Error::OutOfRange {
            what: "points per revolution",
            value: points_per_revolution as f64,
            allowed: "32 or more",
        });
    }
    Ok(points_per_revolution)
}

/// Multiples of `step` that the crank passes from one sample interval before the first sample to
/// one after the last.
fn points_within_one_interval(angle: &CrankAngle, step: f64) -> Range<i64> {
    let a = angle.angles();
    let last = a.len() - 1;
    let low = 2.0 * a[0] - a[1];
    let high = 2.0 * a[last] - a[last - 1];
    (low / step).ceil() as i64..(high / step).floor() as i64 + 1
}

/// A channel over equal steps of the crank angle: whole revolutions, each starting at the same
/// angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolutions {
    samples: Vec<f64>,
    points_per_revolution: usize,
    first_point: usize,
}

impl Revolutions {
    /// All samples, one revolution after the other.
    pub fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// Points per revolution.
    pub fn points_per_revolution(&self) -> usize {
        self.points_per_revolution
    }

    /// How many revolutions there are.
    pub fn count(&self) -> usize {
        self.samples.len() / self.points_per_revolution
    }

    /// The revolutions. Point `j` of each stands at `start_angle() + 2πj/points`.
    pub fn iter(&self) -> std::slice::ChunksExact<'_, f64> {
        self.samples.chunks_exact(self.points_per_revolution)
    }

    /// Crank angle at which every revolution starts, rad in [0, 2π).
    pub fn start_angle(&self) -> f64 {
        TAU * self.first_point as f64 / self.points_per_revolution as f64
    }

    /// Multiple of 2π/points at which every revolution starts.
    pub fn first_point(&self) -> usize {
        self.first_point
    }

    /// e^(−ikθ₀), which turns the phase of order `k` back to crank angle 0.
    pub(crate) fn phase(&self, k: usize) -> Complex64 {
        Complex64::cis(-(k as f64) * self.start_angle())
    }

    /// The crank-angle synchronous mean: the average over the revolutions, point `j` standing at
    /// the crank angle 2πj/points.
    pub fn synchronous_mean(&self) -> Vec<f64> {
        let mut mean = mean_revolution(&self.samples, self.points_per_revolution);
        mean.rotate_right(self.first_point);
        mean
    }
}

/// The average of the stretches of `points` samples.
pub(crate) fn mean_revolution(samples: &[f64], points: usize) -> Vec<f64> {
    let mut mean = vec![0.0; points];
    for revolution in samples.chunks_exact(points) {
        for (sum, x) in mean.iter_mut().zip(revolution) {
            *sum += x;
        }
    }
    let count = (samples.len() / points) as f64;
    for sum in &mut mean {
        *sum /= count;
    }
    mean
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A shaft with 3 % fluctuation of speed at order 2.
    fn shaft(i: usize, samples_per_revolution: f64, start: f64) -> f64 {
        let even = TAU * i as f64 / samples_per_revolution + start;
        even + 0.015 * (2.0 * even).sin()
    }

    fn wave(angle: f64) -> f64 {
        4.0 + 3.0 * (angle + 0.2).cos() + 0.5 * (13.0 * angle).sin()
    }

    fn grid(
        n: usize,
        samples_per_revolution: f64,
        start: f64,
        points: usize,
    ) -> (AngleGrid, Vec<f64>) {
        let angle: Vec<f64> = (0..n)
            .map(|i| shaft(i, samples_per_revolution, start))
            .collect();
        let x = angle.iter().map(|a| wave(*a)).collect();
        let wrapped: Vec<f64> = angle.iter().map(|a| a.rem_euclid(TAU)).collect();
        let angle = CrankAngle::from_encoder(&wrapped).unwrap();
        (AngleGrid::new(&angle, points).unwrap(), x)
    }

    #[test]
    fn wave_over_the_angle_is_met_at_every_point() {
        for (start, points) in [(0.0, 512), (2.0, 512), (5.0, 128)] {
            let (grid, x) = grid(1700, 400.0, start, points);
            let revolutions = grid.resample(&x).unwrap();
            assert_eq!(revolutions.count(), 4);
            for revolution in revolutions.iter() {
                for (j, y) in revolution.iter().enumerate() {
                    let angle = revolutions.start_angle() + TAU * j as f64 / points as f64;
                    assert!((y - wave(angle)).abs() < 1e-4, "{start} {points} {j}: {y}");
                }
            }
            for (j, y) in revolutions.synchronous_mean().iter().enumerate() {
                assert!((y - wave(TAU * j as f64 / points as f64)).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn record_of_whole_revolutions_gives_them_all() {
        for n in [1200, 2400, 3600] {
            for start in [0.0, 1.0, 4.0, 6.2] {
                let (grid, x) = grid(n, 1200.0, start, 2048);
                assert_eq!(grid.resample(&x).unwrap().count(), n / 1200, "{n} {start}");
            }
        }
    }

    #[test]
    fn intervals_add_up_to_the_time_of_the_revolutions() {
        let (grid, _) = grid(1700, 400.0, 1.0, 512);
        let total: f64 = grid.intervals(400.0).unwrap().iter().sum();
        assert!((total - 4.0).abs() < 1e-4, "{total}");
    }

    #[test]
    fn orders_above_the_points_do_not_alias() {
        let angle = CrankAngle::from_speed(6000, 1200.0, 60.0).unwrap();
        let x: Vec<f64> = angle.angles().iter().map(|a| (110.0 * a).cos()).collect();
        let coarse = AngleGrid::new(&angle, 64).unwrap().resample(&x).unwrap();
        // The outermost revolutions see the mirrored ends of the recording.
        let inner = coarse.iter().nth(2).unwrap();
        assert!(inner.iter().all(|y| y.abs() < 1e-4));
        let fine = AngleGrid::new(&angle, 512).unwrap().resample(&x).unwrap();
        let inner = fine.iter().nth(2).unwrap();
        assert!((inner.iter().map(|y| y * y).sum::<f64>() / 512.0 - 0.5).abs() < 1e-4);
    }

    /// A recording of 8 revolutions with 1000 samples in each, resampled to 5 of them from a point of its own. What passes is
    /// met at every point, the ends included; what would alias below 0.4 of the points is gone.
    #[test]
    fn revolutions_from_a_start_are_met_to_their_ends() {
        for (points, start) in [(512, 0), (512, 300), (64, 17)] {
            let angle = CrankAngle::from_speed(8000, 1000.0, 60.0).unwrap();
            let grid = AngleGrid::from_start(&angle, points, start, 5).unwrap();
            let of_order = |order: f64| {
                let x: Vec<f64> = angle
                    .angles()
                    .iter()
                    .map(|a| (order * a + 0.3).sin())
                    .collect();
                grid.resample(&x).unwrap()
            };
            let highest = 0.4 * points as f64;
            // Whole orders: they are alike in each revolution.
            for order in [1.0, (0.5 * highest).floor(), highest.floor() - 1.0] {
                let passed = of_order(order);
                assert_eq!((passed.count(), passed.first_point()), (5, start));
                for (j, y) in passed.samples().iter().enumerate() {
                    let at = TAU * (start + j) as f64 / points as f64;
                    let error = y - (order * at + 0.3).sin();
                    assert!(error.abs() < 1e-4, "{points} {order} {j}: {error:e}");
                }
            }
            // From the first order that would alias below `highest` to the last that interpolation passes.
            let [low, high] = [points as f64 - highest + 1.0, 0.8 * 500.0 - 1.0];
            for share in [0.0, 0.3, 1.0] {
                let order = low + share * (high - low);
                let left = of_order(order);
                let largest = left
                    .samples()
                    .iter()
                    .fold(0.0, |most: f64, y| most.max(y.abs()));
                assert!(largest < 1e-4, "{points} {order}: {largest:e}");
            }
        }
        let short = CrankAngle::from_speed(6900, 1000.0, 60.0).unwrap();
        assert!(matches!(
            AngleGrid::from_start(&short, 512, 511, 5),
            Err(Error::TooFewRevolutions { needed: 8, .. })
        ));
    }

    #[test]
    fn short_recordings_and_other_lengths_are_named() {
        let angle = CrankAngle::from_speed(99, 200.0, 60.0).unwrap();
        let short = AngleGrid::new(&angle, 64).err();
        assert!(matches!(
            short,
            Some(Error::TooFewRevolutions { needed: 1, .. })
        ));
        let angle = CrankAngle::from_speed(300, 200.0, 60.0).unwrap();
        assert!(AngleGrid::new(&angle, 31).is_err());
        let grid = AngleGrid::new(&angle, 64).unwrap();
        assert!(matches!(
            grid.resample(&[0.0; 7]),
            Err(Error::LengthMismatch { got: 7, .. })
        ));
        assert!(grid.intervals(f64::NAN).is_err());
    }
}
