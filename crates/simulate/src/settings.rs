//! How a machine is run: how long, how finely, how accurately.

use std::f64::consts::TAU;

/// Settings of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What is run and thrown away before the recording starts.
    pub transient: Transient,
    /// Revolutions to record.
    pub revolutions: u32,
    /// Sample rate of the recording, Hz.
    pub sample_rate: f64,
    /// Lowest rate at which the motion is sampled before it is decimated to this, Hz; four times
    /// it is the least. Contacts ring at a few kHz: what lies above half of the usual 80 kHz is weak
    /// enough to fold down unnoticed.
    pub inner_rate: f64,
    /// Relative local error of the integration; positions are measured against the clearance.
    pub tolerance: f64,
}

/// How the start is left behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transient {
    /// A fixed number of revolutions.
    Revolutions(u32),
    /// Until the once-a-revolution state repeats (after 1, 2 or 4 revolutions), or at most so
    /// many revolutions.
    Settled {
        /// Largest change of an offset over its clearance, and of a rate over its scale.
        change: f64,
        /// Revolutions after which the recording starts anyway.
        at_most: u32,
    },
}

/// Fewest samples in a revolution: the crank's own frequency must lie in the pass band of the recorder, which
/// reaches to 0.8 of half the sample rate ([`signal::decimate`]).
pub const LEAST_PER_REVOLUTION: f64 = 2.5;
/// Most samples that a channel of a record may have: 2²⁶, half a GiB of numbers for each channel of each
/// case that is simulated at the same time.
pub const MOST_SAMPLES: f64 = 67_108_864.0;

/// Smallest and largest tolerance of an integration.
pub const TOLERANCES: [f64; 2] = [1e-14, 1e-2];

/// A sample rate that gives no record of a machine.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("sample rate: found {rate} Hz, expected {expected}")]
pub struct Unrecordable {
    /// The sample rate, Hz.
    pub rate: f64,
    /// What would be one.
    pub expected: String,
}

impl Settings {
    /// Checks that a machine of this speed, rad/s, can be recorded so.
    ///
    /// # Errors
    /// A sample rate that is too low for a revolution, or too high for the memory.
    pub fn check(&self, speed: f64) -> Result<(), Unrecordable> {
        let (rate, revolutions) = (self.sample_rate, self.revolutions);
        let frequency = speed.abs() / TAU;
        let rpm = frequency * 60.0;
        let least = LEAST_PER_REVOLUTION * frequency;
        let most = MOST_SAMPLES * frequency / f64::from(revolutions.max(1));
        let expected = if rate < least {
            format!("at least {least:.4} Hz, so that a revolution at {rpm:.4} rpm can be seen")
        } else if rate > most {
            format!(
                "at most {most:.4e} Hz, as {revolutions} revolutions at {rpm:.4} rpm would otherwise be more \
                 than {MOST_SAMPLES} samples a channel"
            )
        } else {
            return Ok(());
        };
        Err(Unrecordable { rate, expected })
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            transient: Transient::Revolutions(10),
            revolutions: 20,
            sample_rate: 10_000.0,
            inner_rate: 80_000.0,
            tolerance: 1e-9,
        }
    }
}
