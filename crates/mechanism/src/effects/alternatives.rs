//! What the place of an effect says beyond where it is.

/// What a file says of a place beyond where it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Alternatives {
    /// What an unbalance shakes.
    pub body: Option<Shaken>,
    /// What of a joint is oval.
    pub part: Option<Oval>,
}

/// What is oval in a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Oval {
    /// The bearing.
    Bearing,
    /// The journal.
    Journal,
}

/// What an unbalance shakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shaken {
    /// The frame with everything on it.
    Frame,
    /// The crosshead along its guide.
    Crosshead,
}
