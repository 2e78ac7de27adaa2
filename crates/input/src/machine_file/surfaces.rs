//! The surfaces of a contact.

/// The surfaces that touch.
#[derive(Clone, Copy)]
pub(super) enum Surfaces {
    /// A journal of this radius in a bearing with this clearance, m.
    Journal { radius: f64, clearance: f64 },
    /// Flat faces with this gap, m.
    Flat { clearance: f64 },
}

impl Surfaces {
    /// Their clearance, m.
    pub(super) fn clearance(self) -> f64 {
        match self {
            Self::Journal { clearance, .. } | Self::Flat { clearance } => clearance,
        }
    }
}
