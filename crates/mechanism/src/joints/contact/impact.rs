//! The IMPACT function of ADAMS, which both papers use.
//!
//! ```text
//! F = K δⁿ + STEP(δ, 0, 0, d, C) δ̇
//! STEP(δ, 0, 0, d, C) = C u² (3 − 2u),  u = clamp(δ/d, 0, 1)
//! ```
//!
//! Its restitution depends on the speed of impact. While δ stays well below d, only C/d² is
//! identifiable from the motion.

use super::contact_law;
use super::factors::Factors;
use super::normal::{Normal, NormalForce, power};
use crate::lift::parameters;
use crate::mode::{ContactMode, flagged};
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

contact_law! {
    /// IMPACT of ADAMS (the default): K δⁿ + STEP(δ, 0, 0, depth, damping) dδ/dt.
    Impact, stiffness "Stiffness K. Where only the materials are known, `materials: {pin: steel, bush: bronze}` stands in its place." {
        /// Exponent n of the penetration; 1.5 where it is left out.
        exponent: Number(FromOne), or 1.5;
        /// Greatest damping. No data sheet has it: `crosshead calibrate` estimates it.
        damping: Damping(FromZero);
        /// Penetration at which the damping is full.
        depth: Length(AboveZero);
    }
}

impl<S: Scalar> Normal<S> for Law {
    type Of = Impact<S>;

    #[inline(always)]
    fn force(law: &Impact<S>, penetration: S, rate: S, mode: &ContactMode<S>) -> NormalForce<S> {
        let elastic = law.stiffness * power(penetration, law.exponent);
        // Which side of the kink at u = 1 counts is the mode's to say.
        let u = (penetration / law.depth).max(S::zero());
        let u = flagged(mode.deep, S::one(), u);
        let damping = law.damping * u * u * u.mul_add(S::constant(-2.0), S::constant(3.0));
        NormalForce::damped(elastic, damping * rate)
    }

    fn spring(law: &Impact<S>) -> (S, S) {
        (law.stiffness, law.exponent)
    }

    fn carried_over(law: &Impact<S>, factors: &Factors<S>) -> Impact<S> {
        Impact {
            stiffness: law.stiffness * factors.stiffness,
            exponent: law.exponent,
            damping: law.damping * factors.damping,
            depth: law.depth * factors.depth,
        }
    }

    #[inline(always)]
    fn kink(law: &Impact<S>) -> Option<S> {
        Some(law.depth)
    }
}
