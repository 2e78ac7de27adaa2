//! The family `F = K δⁿ (1 + χ δ̇/v₀)`: laws that differ in how χ follows from the coefficient of
//! restitution e.
//!
//! For any χ of this family the restitution e' that a free impact delivers solves
//! `χ (1 + e') = ln((1 + χ)/(1 − χ e'))`, whatever n, K, mass and v₀.

use super::{NormalForce, power};
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of a law with a coefficient of restitution.
    pub struct Restitution<S> {
        /// Stiffness K, N/mⁿ.
        pub stiffness: S,
        /// Exponent n.
        pub exponent: S,
        /// Coefficient of restitution e.
        pub restitution: S,
        /// Smallest approach speed that v₀ is taken as, m/s: grazing touches would otherwise make
        /// the damping unbounded.
        pub slowest_approach: S,
    }
}

impl<S: Scalar> Restitution<S> {
    #[inline(always)]
    pub(super) fn force(&self, penetration: S, rate: S, approach: S, factor: S) -> NormalForce<S> {
        let elastic = self.stiffness * power(penetration, self.exponent);
        let v0 = approach.max(self.slowest_approach);
        let sign = factor * rate / v0 + 1.0;
        NormalForce {
            raw: elastic * sign,
            elastic,
            excess: [factor * rate, v0],
        }
    }
}
