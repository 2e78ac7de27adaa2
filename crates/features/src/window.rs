//! A stretch of a recording, as features take it.

use signal::channel::Channel;
use simulate::Chamber;

/// A stretch of a recording that is summed up as one row.
#[derive(Clone, Copy, Debug)]
pub struct Window<'a> {
    /// Sample rate, Hz.
    pub sample_rate: f64,
    /// Mean speed of the shaft, rpm, if it is known. Used where there is no crank angle.
    pub speed_rpm: Option<f64>,
    /// Crank angle of each sample. Without one the speed is taken as constant; without either, what
    /// is said per revolution, order or crank angle has no value.
    pub crank_angle: Option<CrankAngles<'a>>,
    /// The channels, all as long as the crank angle. One named `crank_angle_rad` is passed over.
    pub channels: &'a [Channel],
    /// The chambers of the machine, each with the name of the channel that has its pressure. Without
    /// them there is no indicated power.
    pub chambers: &'a [Chamber],
}

/// The crank angle of each sample of a window.
#[derive(Clone, Copy, Debug)]
pub struct CrankAngles<'a> {
    /// In [0, 2π), rad.
    pub angles: &'a [f32],
    /// Whether it counts from top dead centre. If not, as with a tacho whose pulse comes anywhere, the
    /// sectors of the crank angle have no value.
    pub from_top_dead_centre: bool,
}

/// True for a channel that has features: every one but the crank angle.
pub(crate) fn has_features(channel: &str) -> bool {
    channel != "crank_angle_rad"
}
