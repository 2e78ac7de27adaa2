//! Hunt and Crossley 1975, Coefficient of restitution interpreted as damping in vibroimpact: from
//! the energy lost in a nearly elastic impact.

use scalar::Scalar;

/// χ = 3 (1 − e) / 2.
#[inline(always)]
pub(super) fn hysteresis<S: Scalar>(restitution: S) -> S {
    (S::one() - restitution) * 1.5
}
