//! Coulomb's law without its jump: `μ(v) = μ v / √(v² + vs²)` (MODEL.md, section 2).

use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of the regularised law.
    pub struct Coulomb<S> {
        /// Coefficient μ.
        pub coefficient: S,
        /// Slip speed vs over which the jump is spread, m/s.
        pub slip_speed: S,
    }
}

impl<S: Scalar> Coulomb<S> {
    #[inline(always)]
    pub(super) fn coefficient(&self, slip: S) -> S {
        self.coefficient * slip / slip.mul_add(slip, self.slip_speed * self.slip_speed).sqrt()
    }
}
