//! How a machine is run: how long, how finely, how accurately.

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
