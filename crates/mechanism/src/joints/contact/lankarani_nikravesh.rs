//! Lankarani and Nikravesh 1990, A contact force model with hysteresis damping: energy lost in an
//! impact by the momentum balance, for e near 1.

use super::restitution::{Family, restitution_law};
use scalar::Scalar;

restitution_law! {
    /// Lankarani and Nikravesh 1990.
    LankaraniNikravesh
}

impl Family for Law {
    /// χ = 3 (1 − e²) / 4.
    #[inline(always)]
    fn hysteresis<S: Scalar>(restitution: S) -> S {
        (S::one() - restitution * restitution) * 0.75
    }
}
