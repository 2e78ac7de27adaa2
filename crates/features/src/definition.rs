//! What a column of a features table is.

/// What one column of a features table holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// Column name: the channel without its unit, a point, the feature, and the unit if it has
    /// one: `crosshead_acceleration.order_03_m_s2`.
    pub name: String,
    /// The feature alone, without channel and unit: `order_03`.
    pub feature: String,
    /// What it belongs to.
    pub group: Group,
    /// The unit written out, `m/s^2`; `1` for a pure number.
    pub unit: String,
    /// What it is, in a sentence.
    pub description: String,
    /// How it is computed, x being the samples.
    pub formula: &'static str,
    /// Where it is defined.
    pub source: &'static str,
}

/// What features describe of a signal, in the order in which they are documented.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// Of its samples, independent of their order.
    Statistics,
    /// Of its frequencies.
    Spectrum,
    /// Of the shaft's orders.
    Orders,
    /// Of velocity against acceleration.
    Portrait,
    /// Of impacts, by the envelope in the most impulsive band.
    Envelope,
    /// Of what differs within a revolution and between revolutions.
    Revolutions,
    /// Of the p-V card of a chamber.
    Indicator,
    /// Of the kind of motion.
    Motion,
    /// Why values are missing.
    Reasons,
}
