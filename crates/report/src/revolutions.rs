//! A recording cut into revolutions of the crank.

use std::f64::consts::TAU;

/// Points of the mean revolution: one every half degree.
const MEAN_POINTS: usize = 720;

/// A signal over crank angle, one curve per revolution: (angle in degrees from 0 to 360, value).
#[derive(Clone, Debug)]
pub(crate) struct Revolutions {
    /// The curves in order of time; the first and the last may be parts of a revolution.
    pub(crate) curves: Vec<Vec<[f64; 2]>>,
}

impl Revolutions {
    /// Cuts the signal where the crank angle in radians, running on or starting again at every
    /// revolution, passes a whole turn. The shorter of the two slices counts.
    pub(crate) fn new(crank_angle_rad: &[f64], signal: &[f64]) -> Self {
        let mut curves: Vec<Vec<[f64; 2]>> = Vec::new();
        let mut turn = None;
        let mut last = f64::INFINITY;
        for (&angle, &value) in crank_angle_rad.iter().zip(signal) {
            if !angle.is_finite() {
                continue;
            }
            // An angle within a billionth of a turn below a whole one is the start of the next.
            let turns = angle / TAU + 1e-9;
            let within = (turns - turns.floor()) * 360.0;
            if turn != Some(turns.floor()) || within < last {
                curves.push(Vec::new());
                turn = Some(turns.floor());
            }
            last = within;
            if let Some(curve) = curves.last_mut() {
                curve.push([within, value]);
            }
        }
        Self { curves }
    }

    /// The curves that reach over a whole revolution, but for a step of sampling at the ends.
    pub(crate) fn complete(&self) -> impl Iterator<Item = &Vec<[f64; 2]>> {
        self.curves.iter().filter(|curve| {
            let step = 1.5 * 360.0 / curve.len() as f64;
            let reaches =
                |(first, last): (&[f64; 2], &[f64; 2])| first[0] <= step && last[0] >= 360.0 - step;
            curve.len() >= 4 && curve.first().zip(curve.last()).is_some_and(reaches)
        })
    }

    /// The longest curve: a complete revolution if there is one, empty if there is no signal.
    pub(crate) fn longest(&self) -> Vec<[f64; 2]> {
        let extent = |c: &Vec<[f64; 2]>| {
            c.first()
                .zip(c.last())
                .map_or(0.0, |(first, last)| last[0] - first[0])
        };
        let longest =
            self.curves
                .iter()
                .fold(None, |best: Option<&Vec<[f64; 2]>>, curve| match best {
                    Some(best) if extent(best) >= extent(curve) => Some(best),
                    _ => Some(curve),
                });
        self.complete()
            .last()
            .or(longest)
            .cloned()
            .unwrap_or_default()
    }

    /// The mean over the complete revolutions at every half degree; none if there are fewer than two.
    pub(crate) fn mean(&self) -> Option<Vec<[f64; 2]>> {
        let complete: Vec<&Vec<[f64; 2]>> = self.complete().collect();
        if complete.len() < 2 {
            return None;
        }
        let at = |angle: f64| {
            complete
                .iter()
                .map(|curve| value_at(curve, angle))
                .sum::<f64>()
                / complete.len() as f64
        };
        let angles = (0..=MEAN_POINTS).map(|i| i as f64 * 360.0 / MEAN_POINTS as f64);
        Some(angles.map(|angle| [angle, at(angle)]).collect())
    }
}

/// Where the last `turns` revolutions of the crank begin, or the recording if it has fewer.
pub(crate) fn last_turns(crank_angle_rad: &[f64], turns: usize) -> usize {
    let mut left = turns as f64 * TAU * (1.0 + 1e-9);
    let steps = crank_angle_rad.windows(2).rev().take_while(|pair| {
        // At every revolution the angle may start again.
        let step = pair[1] - pair[0];
        left -= if step < 0.0 { step + TAU } else { step };
        left >= 0.0
    });
    let counted = steps.count() + 1;
    crank_angle_rad.len().saturating_sub(counted)
}

/// The value of the curve at the angle: linear between its points, constant beyond its ends.
fn value_at(curve: &[[f64; 2]], angle: f64) -> f64 {
    let after = curve.partition_point(|point| point[0] < angle);
    match (curve.get(after.wrapping_sub(1)), curve.get(after)) {
        (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (angle - a[0]) / (b[0] - a[0]).max(1e-12),
        (Some(end), None) | (None, Some(end)) => end[1],
        (None, None) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_running_and_a_restarting_angle_are_cut_alike() {
        let running: Vec<f64> = (0..1000).map(|i| 1.0 + f64::from(i) * 0.02).collect();
        let restarting: Vec<f64> = running.iter().map(|a| a % TAU).collect();
        let signal: Vec<f64> = running.iter().map(|a| 3.0 * a.cos()).collect();
        for angles in [running, restarting] {
            let revolutions = Revolutions::new(&angles, &signal);
            // From 1 rad to 20.98 rad: the rest of one turn, two whole ones, a part of a fourth.
            assert_eq!(revolutions.curves.len(), 4);
            assert_eq!(revolutions.complete().count(), 2);
            let mean = revolutions.mean().unwrap();
            assert_eq!(mean.len(), 721);
            for [angle, value] in mean {
                // Linear interpolation over 0.02 rad, and at most that step beyond the ends.
                assert!(
                    (value - 3.0 * angle.to_radians().cos()).abs() < 2e-3,
                    "at {angle}: {value}"
                );
            }
        }
    }

    #[test]
    fn the_last_turns_are_counted_from_the_end() {
        // A hundred steps a turn.
        let running: Vec<f64> = (0..=350).map(|i| f64::from(i) * TAU / 100.0).collect();
        let restarting: Vec<f64> = running.iter().map(|a| a % TAU).collect();
        for angles in [running, restarting] {
            assert_eq!(last_turns(&angles, 2), 150);
            assert_eq!(last_turns(&angles, 4), 0);
        }
        assert_eq!(last_turns(&[], 4), 0);
        assert_eq!(last_turns(&[f64::NAN; 3], 1), 2);
    }

    #[test]
    fn a_signal_shorter_than_a_revolution_has_no_mean() {
        let revolutions = Revolutions::new(&[0.1, 0.2, f64::NAN, 0.3], &[1.0, 2.0, 3.0]);
        assert_eq!(revolutions.longest().len(), 2);
        assert!(revolutions.mean().is_none());
        assert!(Revolutions::new(&[], &[]).longest().is_empty());
    }
}
