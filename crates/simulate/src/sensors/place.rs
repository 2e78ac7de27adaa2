//! Where a sensor sits.

/// Where a sensor sits, as far as it has a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Place {
    /// Index of the throw.
    pub throw: usize,
    /// The direction that it feels.
    pub axis: Axis,
    /// The chamber of the cylinder.
    pub end: ChamberEnd,
}

impl Place {
    /// Index of the channel: a sensor has a choice of axes, or of chambers, or none.
    pub(super) fn channel(&self) -> usize {
        self.axis as usize + self.end as usize
    }
}

/// A key of the machine file that says where a sensor sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceKey {
    /// A throw by its name; it may be left out where there is one.
    Throw,
    /// The direction that it feels.
    Axis,
    /// Head end or crank end; head where it is left out.
    End,
}

/// A direction of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Axis {
    /// Along the cylinder.
    #[default]
    X,
    /// Across it.
    Y,
}

/// A chamber of a cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ChamberEnd {
    /// Between piston and head.
    #[default]
    Head,
    /// Between piston and crank-end cover.
    Crank,
}
