//! Flores, Machado, Silva and Martins 2011, On the continuous contact force models for soft
//! materials: usable for small e too.

use super::restitution::{Family, restitution_law};
use scalar::Scalar;

restitution_law! {
    /// Flores, Machado, Silva and Martins 2011.
    Flores
}

impl Family for Law {
    /// χ = 8 (1 − e) / (5 e).
    #[inline(always)]
    fn hysteresis<S: Scalar>(restitution: S) -> S {
        (S::one() - restitution) * 1.6 / restitution
    }
}
