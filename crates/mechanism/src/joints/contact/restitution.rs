//! The family `F = K δⁿ (1 + χ δ̇/v₀)`: laws that differ in how χ follows from the coefficient of
//! restitution e.
//!
//! The restitution e' of a free impact solves `χ (1 + e') = ln((1 + χ)/(1 − χ e'))`, for any n, K, mass
//! and v₀.

use super::factors::Factors;
use super::normal::{Normal, NormalForce, power};
use crate::lift::parameters;
use crate::mode::ContactMode;
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

/// A law of the family.
pub(super) trait Family {
    /// The hysteresis damping factor χ of a coefficient of restitution.
    fn hysteresis<S: Scalar>(restitution: S) -> S;
}

impl<S: Scalar, F: Family> Normal<S> for F {
    type Of = Restitution<S>;

    #[inline(always)]
    fn force(
        law: &Restitution<S>,
        penetration: S,
        rate: S,
        mode: &ContactMode<S>,
    ) -> NormalForce<S> {
        let factor = F::hysteresis(law.restitution);
        let elastic = law.stiffness * power(penetration, law.exponent);
        let v0 = mode.approach.max(law.slowest_approach);
        let sign = factor * rate / v0 + 1.0;
        NormalForce {
            raw: elastic * sign,
            elastic,
            excess: [factor * rate, v0],
        }
    }

    fn spring(law: &Restitution<S>) -> (S, S) {
        (law.stiffness, law.exponent)
    }

    fn carried_over(law: &Restitution<S>, factors: &Factors<S>) -> Restitution<S> {
        Restitution {
            stiffness: law.stiffness * factors.stiffness,
            ..law.clone()
        }
    }

    fn remembers() -> bool {
        true
    }
}

/// Declares a law of the family: what it is, and its name.
macro_rules! restitution_law {
    ($(#[doc = $about:literal])+ $name:ident) => {
        /// The parameters of the law: those of its family.
        pub type $name<S = f64> = super::restitution::Restitution<S>;

        super::contact_law! {
            $(#[doc = $about])+
            $name, stiffness "Stiffness K. Where only the materials are known, `materials: {pin: steel, bush: bronze}` stands in its place." {
                /// Exponent n of the penetration; 1.5 where it is left out.
                exponent: Number(FromOne), or 1.5;
                /// Coefficient of restitution.
                restitution: Number(Rebound);
                /// Smallest approach speed that the damping is computed with; 1 mm/s where it is left out.
                slowest_approach: Velocity(AboveZero), or 1e-3;
            }
        }
    };
}

pub(super) use restitution_law;
