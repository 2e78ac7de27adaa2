//! The IMPACT function of ADAMS, which both papers use.
//!
//! ```text
//! F = K δⁿ + STEP(δ, 0, 0, d, C) δ̇
//! STEP(δ, 0, 0, d, C) = C u² (3 − 2u),  u = clamp(δ/d, 0, 1)
//! ```
//!
//! Its restitution depends on the speed of impact; while δ stays well below d only C/d² can be
//! told from the motion.

use super::{NormalForce, power};
use crate::lift::parameters;
use crate::mode::flagged;
use scalar::Scalar;

parameters! {
    /// Parameters of IMPACT.
    pub struct Impact<S> {
        /// Stiffness K, N/mⁿ.
        pub stiffness: S,
        /// Exponent n.
        pub exponent: S,
        /// Greatest damping C, N s/m.
        pub damping: S,
        /// Penetration d at which the damping is full, m.
        pub depth: S,
    }
}

impl<S: Scalar> Impact<S> {
    #[inline(always)]
    pub(super) fn force(&self, penetration: S, rate: S, deep: S) -> NormalForce<S> {
        let elastic = self.stiffness * power(penetration, self.exponent);
        // Which side of the kink at u = 1 counts is the mode's to say.
        let u = flagged(deep, S::one(), (penetration / self.depth).max(S::zero()));
        let damping = self.damping * u * u * u.mul_add(S::constant(-2.0), S::constant(3.0));
        NormalForce::damped(elastic, damping * rate)
    }
}
