//! A sampled channel.

/// Samples of one quantity at a constant rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Column name, ending in the unit: `crosshead_acceleration_m_s2`.
    pub name: String,
    /// The unit written out: `m/s^2`.
    pub unit: String,
    /// The samples.
    pub samples: Vec<f32>,
}
