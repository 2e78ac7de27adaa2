//! By how much the parameters of a contact law change with the clearance.

/// Factors on the parameters of a law.
pub(in crate::joints) struct Factors<S> {
    pub stiffness: S,
    pub damping: S,
    pub depth: S,
}
