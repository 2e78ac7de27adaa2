//! The velocity-acceleration portrait of a reciprocating part.

use crate::angle_resampling::{AngleGrid, Revolutions, mean_revolution};
use crate::error::{Error, positive};
use fourier::Complex64;
use std::f64::consts::TAU;

/// Velocity against acceleration: one loop per revolution.
#[derive(Clone, Debug, PartialEq)]
pub struct PhasePortrait {
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    points_per_revolution: usize,
    area: f64,
}

impl PhasePortrait {
    /// From the acceleration over equal crank angles, m/s², and the `grid` that it was resampled
    /// with. `sample_rate` of the recording in Hz.
    ///
    /// The velocity is the integral over time, v(θ) = ∫ (a − ā) (dt/dθ) dθ, taken in the
    /// frequency domain over all whole revolutions. A part that comes back to its place has no
    /// mean velocity, and its acceleration no mean over time. Both are removed, and with them
    /// everything slower than half the shaft's speed, where a sensor's drift would swamp the
    /// integral. Thus the velocity cannot drift.
    ///
    /// # Errors
    /// An acceleration that does not belong to the grid; a sample rate that is not positive.
    pub fn new(
        acceleration: &Revolutions,
        grid: &AngleGrid,
        sample_rate: f64,
    ) -> Result<Self, Error> {
        let a = acceleration.samples();
        let intervals = grid.intervals(sample_rate)?;
        if intervals.len() != a.len() {
            return Err(Error::LengthMismatch {
                what: "acceleration beside its grid of crank angles",
                got: a.len(),
                expected: intervals.len(),
            });
        }
        let time: f64 = intervals.iter().sum();
        let mean = a.iter().zip(&intervals).map(|(a, dt)| a * dt).sum::<f64>() / time;
        let centred: Vec<f64> = a.iter().map(|a| a - mean).collect();
        let squares = centred.iter().zip(&intervals).map(|(a, dt)| a * a * dt);
        let area = squares.sum::<f64>() / acceleration.count() as f64;
        let increments = centred.iter().zip(&intervals).map(|(a, dt)| a * dt);
        let points = acceleration.points_per_revolution();
        Ok(Self {
            velocity: integrate(increments.collect(), points),
            acceleration: centred,
            points_per_revolution: points,
            area,
        })
    }

    /// Velocity over equal crank angles, m/s, one revolution after the other.
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Acceleration without its mean over time, m/s², at the same angles.
    pub fn acceleration(&self) -> &[f64] {
        &self.acceleration
    }

    /// Area that a revolution encloses, m²/s³, averaged over the revolutions and positive the way
    /// the motion goes. It is ½ ∮ (a dv − v da) = ∮ a dv = ∫ a² dt. The last is what is computed. It is exact
    /// where a polygon through the points falls short by its chords, 5e-4 where an impact is
    /// sampled coarsely. The area is thus the time of a revolution times the mean square of
    /// the acceleration.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Width of a revolution, peak to peak of the velocity, m/s, averaged over the revolutions.
    pub fn velocity_extent(&self) -> f64 {
        self.average(|(v, _)| extent(v))
    }

    /// Height of a revolution, peak to peak of the acceleration, m/s², averaged over the
    /// revolutions.
    pub fn acceleration_extent(&self) -> f64 {
        self.average(|(_, a)| extent(a))
    }

    /// RMS distance of the revolutions from the mean loop over the mean loop's RMS radius, with
    /// either axis in units of the mean loop's RMS on it:
    /// √(½ (⟨(v − v̄)²⟩/⟨v̄²⟩ + ⟨(a − ā)²⟩/⟨ā²⟩)). 0 for a motion that repeats itself.
    ///
    /// # Errors
    /// Fewer than two revolutions, or a mean loop that is a point.
    pub fn scatter(&self) -> Result<f64, Error> {
        let revolutions = self.velocity.len() / self.points_per_revolution;
        if revolutions < 2 {
            return Err(Error::TooFewRevolutions {
                needed: 2,
                got: revolutions as f64,
            });
        }
        let v = relative_scatter(&self.velocity, self.points_per_revolution)?;
        let a = relative_scatter(&self.acceleration, self.points_per_revolution)?;
        Ok((0.5 * (v + a)).sqrt())
    }

    fn average(&self, measure: impl Fn((&[f64], &[f64])) -> f64) -> f64 {
        let n = self.points_per_revolution;
        let loops = self
            .velocity
            .chunks_exact(n)
            .zip(self.acceleration.chunks_exact(n));
        let count = loops.len() as f64;
        loops.map(measure).sum::<f64>() / count
    }
}

/// The periodic integral of `increments` per point, without what is slower than half a cycle per
/// revolution of `points`.
fn integrate(mut increments: Vec<f64>, points: usize) -> Vec<f64> {
    let n = increments.len();
    let revolutions = n / points;
    let mut spectrum = fourier::forward(&mut increments);
    for (k, c) in spectrum.iter_mut().enumerate() {
        if 2 * k < revolutions || k == 0 || 2 * k == n {
            *c = Complex64::ZERO;
        } else {
            // 1/(iω) per point, and the 1/n of the inverse.
            *c *= Complex64::new(0.0, -1.0 / (TAU * k as f64));
        }
    }
    fourier::inverse(spectrum, n)
}

fn extent(x: &[f64]) -> f64 {
    let low = x.iter().copied().fold(f64::INFINITY, f64::min);
    let high = x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    high - low
}

/// Mean square about the mean revolution over the mean square of the mean revolution.
fn relative_scatter(x: &[f64], points: usize) -> Result<f64, Error> {
    let mean = mean_revolution(x, points);
    let square = mean.iter().map(|m| m * m).sum::<f64>() / points as f64;
    positive("mean square of the mean revolution", square)?;
    let squares = x.chunks_exact(points).flat_map(|r| r.iter().zip(&mean));
    let distance: f64 = squares.map(|(x, m)| (x - m).powi(2)).sum();
    Ok(distance / x.len() as f64 / square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crank_angle::CrankAngle;

    const RATE: f64 = 10_000.0;
    const SPEED: f64 = 50.0;

    /// The portrait of x(t), given by its acceleration as a function of time, on a crank that
    /// turns by `shaft`.
    fn portrait(
        n: usize,
        shaft: impl Fn(f64) -> f64,
        acceleration: impl Fn(f64) -> f64,
    ) -> (PhasePortrait, Vec<f64>) {
        let times: Vec<f64> = (0..n).map(|i| i as f64 / RATE).collect();
        let wrapped: Vec<f64> = times.iter().map(|t| shaft(*t).rem_euclid(TAU)).collect();
        let grid = AngleGrid::new(&CrankAngle::from_encoder(&wrapped).unwrap(), 2048).unwrap();
        let a: Vec<f64> = times.iter().map(|t| acceleration(*t)).collect();
        let resampled = grid.resample(&a).unwrap();
        let portrait = PhasePortrait::new(&resampled, &grid, RATE).unwrap();
        (portrait, grid.resample(&times).unwrap().samples().to_vec())
    }

    /// Area of the polygon through the points of the first revolution.
    fn polygon(portrait: &PhasePortrait) -> f64 {
        let n = portrait.points_per_revolution;
        let [v, a] = [portrait.velocity(), portrait.acceleration()];
        let next = |i: usize| (i + 1) % n;
        (0..n)
            .map(|i| 0.5 * (a[i] * v[next(i)] - v[i] * a[next(i)]))
            .sum()
    }

    /// v = V sin ωt: an ellipse of half axes V and Vω, to which a sensor's offset adds nothing.
    #[test]
    fn harmonic_motion_is_an_ellipse() {
        let (v, w) = (6.0, SPEED);
        let (portrait, _) = portrait(6500, |t| w * t, |t| v * w * (w * t).cos() + 4.0);
        let ellipse = std::f64::consts::PI * v * v * w;
        assert!((portrait.area() / ellipse - 1.0).abs() < 1e-4);
        assert!((polygon(&portrait) / ellipse - 1.0).abs() < 1e-4);
        assert!((portrait.velocity_extent() / (2.0 * v) - 1.0).abs() < 1e-4);
        assert!((portrait.acceleration_extent() / (2.0 * v * w) - 1.0).abs() < 1e-4);
        assert!(portrait.scatter().unwrap() < 1e-4);
    }

    /// x = sin θ + ¼ cos 3θ over θ = ωt + 0.01 sin 2ωt: the velocity is known in closed form.
    #[test]
    fn velocity_is_right_where_the_speed_fluctuates() {
        let w = SPEED;
        let phase = |t: f64| w * t + 0.01 * (2.0 * w * t).sin();
        let rate = |t: f64| w + 0.02 * w * (2.0 * w * t).cos();
        let rate_change = |t: f64| -0.04 * w * w * (2.0 * w * t).sin();
        let velocity = |t: f64| (phase(t).cos() - 0.75 * (3.0 * phase(t)).sin()) * rate(t);
        let acceleration = |t: f64| {
            let curvature = -phase(t).sin() - 2.25 * (3.0 * phase(t)).cos();
            let slope = phase(t).cos() - 0.75 * (3.0 * phase(t)).sin();
            curvature * rate(t).powi(2) + slope * rate_change(t)
        };
        let (portrait, times) = portrait(5200, phase, acceleration);
        for (v, t) in portrait.velocity().iter().zip(times) {
            assert!(
                (v - velocity(t)).abs() < 1e-3 * w,
                "{t}: {v} {}",
                velocity(t)
            );
        }
    }

    /// Velocities V(1 ± ε) sin ωt in turn: both axes scatter by ε.
    #[test]
    fn alternating_amplitude_scatters_by_its_share() {
        let (w, share) = (SPEED, 0.2);
        let portrait = |t: f64| {
            let sign = if (t * w / TAU).floor() as i64 % 2 == 0 {
                1.0
            } else {
                -1.0
            };
            (1.0 + share * sign) * w * (w * t).cos()
        };
        // The acceleration steps where the revolutions join, and the velocity with its slope.
        let period = TAU / w * RATE;
        let (portrait, _) = self::portrait((20.0 * period).round() as usize, |t| w * t, portrait);
        assert!((portrait.scatter().unwrap() - share).abs() < 0.01 * share);
    }

    #[test]
    fn single_revolutions_and_points_have_no_scatter() {
        let w = SPEED;
        let (one, _) = portrait(1300, |t| w * t, |t| (w * t).cos());
        let few = Error::TooFewRevolutions {
            needed: 2,
            got: 1.0,
        };
        assert_eq!(one.scatter(), Err(few));
        let (still, _) = portrait(6500, |t| w * t, |_| 0.0);
        assert!(matches!(still.scatter(), Err(Error::OutOfRange { .. })));
        assert_eq!(still.area(), 0.0);
    }
}
