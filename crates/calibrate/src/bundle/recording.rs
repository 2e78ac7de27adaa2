//! The recording of a run: its channels in SI units, and where its crank stood.

use super::series::{Series, samples_of};
use crate::observation::Channel;
use input::bundle::{self, ANY_SPEED, Bundle};
use input::bundle_channel::Meaning;
use signal::crank_angle::CrankAngle;
use signal::tacho;
use std::f64::consts::TAU;

/// A recording.
pub(super) struct Recording {
    pub(super) speed_rpm: f64,
    pub(super) sample_rate: f64,
    /// Whether the bundle or the file states the sample rate, or has times.
    pub(super) is_timed: bool,
    /// In [0, 2π), rad; its zero is not known where it comes from a tacho without an angle.
    pub(super) crank_angle: Option<Vec<f64>>,
    pub(super) channels: Vec<Channel>,
}

/// Reads the recording of a run whose channels have these meanings.
///
/// # Errors
/// In words, what is wrong with it.
pub(super) fn read(
    bundle: &Bundle,
    run: &bundle::Run,
    meanings: &[Meaning],
) -> Result<Recording, String> {
    let listed = || run.channels.iter().zip(meanings);
    let series = Series::of_run(bundle, run, meanings)?;
    let sample_rate = series.first().and_then(|series| series.sample_rate);
    let mut crank_angle = None;
    let mut pulses = None;
    let mut channels = Vec::new();
    for (channel, meaning) in listed() {
        let samples = || samples_of(&series, channel).iter().copied();
        match meaning {
            Meaning::CrankAngle(to_si) => {
                let wrapped = samples().map(|x| to_si.apply(x).rem_euclid(TAU));
                crank_angle = Some(wrapped.collect::<Vec<f64>>());
            }
            Meaning::Tacho { at } => {
                let angle = tacho::from_pulses(&samples().collect::<Vec<f64>>());
                let angle = angle.map_err(|e| format!("channel {}: {e}", channel.column))?;
                let at = at.unwrap_or(0.0);
                pulses = Some(angle.iter().map(|a| (a + at).rem_euclid(TAU)).collect());
            }
            Meaning::Measured { column, to_si } => channels.push(Channel {
                column: column.clone(),
                samples: samples().map(|x| to_si.apply(x)).collect(),
            }),
            Meaning::Time | Meaning::Other => {}
        }
    }
    let crank_angle = crank_angle.or(pulses);
    let stated = run.speed_rpm.map(|speed| speed.get());
    let per_revolution = match &crank_angle {
        Some(angle) => {
            let angle = CrankAngle::from_encoder(angle);
            let angle = angle.map_err(|error| format!("channel crank angle: {error}"))?;
            Some(angle.samples_per_revolution())
        }
        None => None,
    };
    let timed = sample_rate.is_some();
    let (speed_rpm, sample_rate) = match (stated, sample_rate, per_revolution) {
        (Some(speed), Some(rate), _) => (speed, rate),
        (None, Some(rate), Some(samples)) => (60.0 * rate / samples, rate),
        // Over the crank angle alone: as if it turned evenly.
        (speed, None, Some(samples)) => {
            if speed.is_none() && channels.iter().any(|c| c.quantity().is_vibration()) {
                return Err("a vibration needs speed_rpm, or times or sample_rate_hz".into());
            }
            let speed = speed.unwrap_or(ANY_SPEED);
            (speed, samples * speed / 60.0)
        }
        (_, None, None) => {
            return Err(
                "its sample rate is not known: sample_rate_hz is missing, and there is \
                        neither a column of time nor a crank angle"
                    .into(),
            );
        }
        (None, Some(_), None) => {
            return Err("speed_rpm is missing, and there is no crank angle to take it from".into());
        }
    };
    Ok(Recording {
        speed_rpm,
        sample_rate,
        is_timed: timed,
        crank_angle,
        channels,
    })
}
