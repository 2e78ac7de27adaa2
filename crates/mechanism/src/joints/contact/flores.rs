//! Flores, Machado, Silva and Martins 2011, On the continuous contact force models for soft
//! materials: usable for small e too.

use scalar::Scalar;

/// χ = 8 (1 − e) / (5 e).
#[inline(always)]
pub(super) fn hysteresis<S: Scalar>(restitution: S) -> S {
    (S::one() - restitution) * 1.6 / restitution
}
