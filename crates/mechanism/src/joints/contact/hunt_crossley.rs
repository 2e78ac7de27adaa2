//! Hunt and Crossley 1975, Coefficient of restitution interpreted as damping in vibroimpact: from
//! the energy lost in a nearly elastic impact.

use super::restitution::{Family, restitution_law};
use scalar::Scalar;

restitution_law! {
    /// Hunt and Crossley 1975.
    HuntCrossley
}

impl Family for Law {
    /// χ = 3 (1 − e) / 2.
    #[inline(always)]
    fn hysteresis<S: Scalar>(restitution: S) -> S {
        (S::one() - restitution) * 1.5
    }
}
