//! The windows of a recording over the crank angle: as many samples in each revolution, whole revolutions, all from one
//! angle. See [`AngleGrid::from_start`] for the bounds of what resampling changes.

use std::ops::Range;

use signal::angle_resampling::AngleGrid;
use signal::channel::Channel;
use signal::crank_angle::CrankAngle;

use super::recording::{CRANK_ANGLE, Failure, Recording};
use crate::plan::{Case, OverAngle};

/// A window of a recording.
pub(super) struct AngleWindow {
    /// Its samples in the recording.
    pub recorded: Range<usize>,
    /// The channels over the crank angle.
    pub channels: Vec<Channel>,
}

/// The windows of a case.
///
/// # Errors
/// Readings that are no motion of a crank, and a recording that is too short.
pub(super) fn windows(
    case: &Case,
    recording: &Recording,
    over_angle: OverAngle,
    revolutions: u32,
) -> Result<Vec<AngleWindow>, Failure> {
    let (count, each) = match case.windows {
        Some(windows) => (windows.count.get(), windows.revolutions.get()),
        None => (1, revolutions),
    };
    let numbers =
        |channel: &Channel| -> Vec<f64> { channel.samples.iter().map(|x| f64::from(*x)).collect() };
    let encoder = recording.channels.iter().find(|c| c.name == CRANK_ANGLE);
    let samples = recording.channels.first().map_or(0, |c| c.samples.len());
    let angle = CrankAngle::recorded(
        encoder.map(numbers).as_deref(),
        samples,
        recording.sample_rate_hz,
        case.operating_point.speed_rpm,
    )?;
    let points = over_angle.samples_per_revolution as usize;
    let start = over_angle.start_of(case);
    let [count, each] = [count as usize, each as usize];
    let grid = AngleGrid::from_start(&angle, points, start as usize, count * each)?;
    let resampled = |channel: &Channel| -> Result<Vec<f32>, signal::Error> {
        // The angle jumps once a revolution; at the points it is known.
        if channel.name == CRANK_ANGLE {
            let points = (start..).take(count * each * points);
            let of_turn = points.map(|p| over_angle.angle(p % over_angle.samples_per_revolution));
            return Ok(of_turn.map(|angle| angle as f32).collect());
        }
        let over_angle = grid.resample(&numbers(channel))?;
        Ok(over_angle.samples().iter().map(|x| *x as f32).collect())
    };
    let channels = recording.channels.iter().map(resampled);
    let channels = channels.collect::<Result<Vec<_>, _>>()?;
    let [begin, end] = grid.ends();
    let length = (end - begin) / count as f64;
    let window = |index: usize| {
        let first = (begin + index as f64 * length).round() as usize;
        let points = index * each * points..(index + 1) * each * points;
        let of_channel = |(channel, samples): (&Channel, &Vec<f32>)| Channel {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            samples: samples[points.clone()].to_vec(),
        };
        AngleWindow {
            recorded: first..first + length.floor() as usize,
            channels: recording
                .channels
                .iter()
                .zip(&channels)
                .map(of_channel)
                .collect(),
        }
    };
    Ok((0..count).map(window).collect())
}
