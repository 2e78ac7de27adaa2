//! Where in the machine an effect acts.

/// Where an effect acts, as far as its law leaves a choice. What is left open means everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Index of the throw.
    pub throw: Option<usize>,
    /// The joint.
    pub joint: Option<Joint>,
    /// The chamber of the cylinder.
    pub end: Option<End>,
}

/// A joint of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// Crankshaft in frame.
    Main,
    /// Crank pin in rod.
    BigEnd,
    /// Crosshead pin in rod.
    SmallEnd,
}

/// A chamber of a cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Between piston and head.
    Head,
    /// Between piston and crank-end cover.
    Crank,
}
