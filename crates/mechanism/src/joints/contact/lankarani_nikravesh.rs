//! Lankarani and Nikravesh 1990, A contact force model with hysteresis damping: energy lost in an
//! impact by the momentum balance, for e near 1.

use scalar::Scalar;

/// χ = 3 (1 − e²) / 4.
#[inline(always)]
pub(super) fn hysteresis<S: Scalar>(restitution: S) -> S {
    (S::one() - restitution * restitution) * 0.75
}
