//! A sensor: what it measures, and what the measuring chain does to it.

pub use crate::sensors::{Axis, ChamberEnd, Measured};
pub use crate::structure::{Resonance, Structure};

/// One sensor of the machine file: a measured quantity seen through a measuring chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// What it sees.
    pub measured: Measured,
    /// What happens on the way to the recording.
    pub chain: Chain,
}

impl Sensor {
    /// The sensor without what its chain adds: what is left is linear, and takes derivatives.
    pub(crate) fn without_additions(&self) -> Self {
        let mut sensor = self.clone();
        sensor.chain.hum = None;
        sensor.chain.offset = 0.0;
        sensor.chain.angle_offset = 0.0;
        sensor
    }

    /// Whether no contact moves it at once, and it filters nothing.
    pub(crate) fn is_smooth(&self) -> bool {
        let smooth = !self.measured.entry().declaration.feels_contacts;
        smooth && self.chain.mounting.is_none() && self.chain.low_pass.is_none()
    }
}

/// What kind of quantity a channel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// An acceleration, m/s². Sensors of it do not see its mean.
    Acceleration,
    /// A velocity of what vibrates, m/s. Sensors of it do not see its mean.
    Velocity,
    /// A gas pressure, Pa.
    Pressure,
    /// Anything else.
    Other,
}

impl Quantity {
    /// By the name of a column, as [`Measured::column`] gives it.
    pub fn of_column(column: &str) -> Self {
        let name = column.rsplit('.').next().unwrap_or(column);
        if name.contains("acceleration") {
            Self::Acceleration
        } else if name.contains("velocity") {
            Self::Velocity
        } else if name.contains("pressure") {
            Self::Pressure
        } else {
            Self::Other
        }
    }

    /// Whether the mean of a recording says something of the quantity.
    pub fn has_mean(self) -> bool {
        !self.is_vibration()
    }

    /// Whether it is an acceleration.
    pub fn is_acceleration(self) -> bool {
        self == Self::Acceleration
    }

    /// Whether it is an acceleration or a velocity.
    pub fn is_vibration(self) -> bool {
        matches!(self, Self::Acceleration | Self::Velocity)
    }

    /// Whether it is a pressure.
    pub fn is_pressure(self) -> bool {
        self == Self::Pressure
    }
}

/// What happens between the quantity and the recorded number, in this order: structure, delay, mounting resonance, low-pass, gain, high-pass, hum, offset, noise, range, quantisation; of an encoder the offset of its zero alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// What carries the sensor, where that swings: the machine's, not the sensor's.
    pub structure: Option<Structure>,
    /// By how much the recorded number is late, s.
    pub delay: f64,
    /// Resonance of the sensor on its mount.
    pub mounting: Option<Resonance>,
    /// Low-pass of the amplifier.
    pub low_pass: Option<LowPass>,
    /// Frequency below which the channel does not pass, by a filter of the first order (−3 dB there), Hz.
    pub high_pass: Option<f64>,
    /// Factor on the value (1 when calibrated right).
    pub gain: f64,
    /// Mains hum on the cable, after the gain.
    pub hum: Option<Hum>,
    /// Constant that is added after the gain, in the channel's unit; 0 when the sensor's zero is right.
    pub offset: f64,
    /// What an encoder reads at angle 0, rad.
    pub angle_offset: f64,
    /// Noise added.
    pub noise: Option<Noise>,
    /// What magnitudes are recorded.
    pub range: Option<Range>,
    /// Resolution of the converter over ± the range, bits.
    pub bits: Option<u32>,
}

impl Default for Chain {
    fn default() -> Self {
        Self {
            structure: None,
            delay: 0.0,
            mounting: None,
            low_pass: None,
            high_pass: None,
            gain: 1.0,
            hum: None,
            offset: 0.0,
            angle_offset: 0.0,
            noise: None,
            range: None,
            bits: None,
        }
    }
}

/// Largest magnitude that a recorder holds, in the channel's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// The same in every record; beyond it the record is flat.
    Fixed(f64),
    /// Set to each record: its own largest magnitude.
    Auto,
}

/// A sine whose frequency is independent of the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hum {
    /// Amplitude, in the channel's unit.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Phase of the cosine at the start of the machine, rad.
    pub phase: f64,
}

/// A Butterworth low-pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowPass {
    /// Frequency of −3 dB, Hz.
    pub cutoff: f64,
    /// Order, 1 to 8.
    pub order: u32,
}

/// Gaussian noise: white, plus 1/f.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// RMS of the whole noise.
    pub level: NoiseLevel,
    /// Share of its power that is 1/f, 0 to 1.
    pub pink_share: f64,
}

/// How the size of the noise is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoiseLevel {
    /// RMS in the channel's unit.
    Absolute(f64),
    /// RMS as a share of the signal's own RMS about its mean.
    OfSignal(f64),
}
