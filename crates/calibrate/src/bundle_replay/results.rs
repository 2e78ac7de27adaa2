//! How far the replays of a bundle are from its recordings: the content of `replay.json`.

use crate::relation_spread::RelationSpread;
use crate::replay::{Replay, Replayed};
use crate::results::ByName;
use serde::Serialize;

/// What the keys of the runs mean.
const MEANING: [(&str, &str); 6] = [
    ("recording_rms", "RMS of the recording about its mean, SI"),
    (
        "difference",
        "RMS of the difference of the crank-angle synchronous means, over recording_rms",
    ),
    (
        "noise_floor",
        "RMS of the noise in the recording's synchronous mean, over recording_rms",
    ),
    (
        "misfit",
        "the same difference, order by order, over the standard deviation of its noise: 1 is noise alone",
    ),
    (
        "relation_spread",
        "at clearances that the machine is not known at: what each relation that the recordings do not exclude shows, and the least and the greatest of them; null elsewhere",
    ),
    (
        "periodic",
        "false where the simulated motion does not repeat itself; then compare means, not waveforms",
    ),
];

/// How far the replays are from the recordings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Results {
    /// What the keys of the runs mean.
    meaning: ByName<&'static str>,
    /// The runs.
    pub runs: ByName<RunReplay>,
}

/// How far the replay of a run is from its recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunReplay {
    /// False where the simulated motion does not repeat itself.
    pub periodic: bool,
    /// Mean speed of the recording, rpm.
    pub recorded_speed_rpm: f64,
    /// Mean speed of the simulation, rpm.
    pub simulated_speed_rpm: f64,
    /// RMS of the simulated crank angle's difference from the recorded one, rad.
    pub crank_angle_difference_rad: f64,
    /// Misfit of the run, in standard deviations of the noise.
    pub misfit: f64,
    /// The channels, by column.
    pub channels: ByName<ChannelReplay>,
    /// The spread over the relations; none where the run was recorded at the clearances that the machine
    /// states.
    pub relation_spread: Option<RelationSpread>,
}

/// How far a simulated channel is from the recorded one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChannelReplay {
    /// RMS of the recording about its mean, SI.
    pub recording_rms: f64,
    /// RMS of the difference of the synchronous means, over `recording_rms`.
    pub difference: f64,
    /// RMS of the noise in the recording's synchronous mean, over `recording_rms`.
    pub noise_floor: f64,
    /// Misfit, in standard deviations of the noise.
    pub misfit: f64,
}

impl Results {
    pub(super) fn from_runs(runs: ByName<RunReplay>) -> Self {
        let meaning = MEANING.map(|(key, meaning)| (key.to_owned(), meaning));
        Self {
            meaning: meaning.into_iter().collect(),
            runs,
        }
    }
}

impl RunReplay {
    pub(super) fn from_replay(replay: &Replay, relation_spread: Option<RelationSpread>) -> Self {
        let channel = |channel: &Replayed| {
            let share = |value: f64| value / channel.recording_rms;
            let replay = ChannelReplay {
                recording_rms: channel.recording_rms,
                difference: share(channel.difference),
                noise_floor: share(channel.noise_floor),
                misfit: channel.misfit,
            };
            (channel.column.clone(), replay)
        };
        Self {
            periodic: replay.periodic,
            recorded_speed_rpm: replay.recorded_rpm,
            simulated_speed_rpm: replay.simulated_rpm,
            crank_angle_difference_rad: replay.angle_difference,
            misfit: replay.misfit,
            channels: replay.channels.iter().map(channel).collect(),
            relation_spread,
        }
    }
}
