//! Hertz 1881: `F = K δⁿ` (n = 3/2 for point contact), without dissipation.

use super::contact_law;
use super::factors::Factors;
use super::normal::{Normal, NormalForce, power};
use crate::lift::parameters;
use crate::mode::ContactMode;
use scalar::Scalar;

parameters! {
    /// Parameters of the elastic law.
    pub struct Hertz<S> {
        /// Stiffness K, N/mⁿ.
        pub stiffness: S,
        /// Exponent n.
        pub exponent: S,
    }
}

contact_law! {
    /// K δⁿ, without loss (Hertz 1881).
    Hertz, stiffness "Stiffness K. Where only the materials are known, `materials: {pin: steel, bush: bronze}` stands in its place." {
        /// Exponent n of the penetration; 1.5 where it is left out.
        exponent: Number(FromOne), or 1.5;
    }
}

impl<S: Scalar> Normal<S> for Law {
    type Of = Hertz<S>;

    #[inline(always)]
    fn force(law: &Hertz<S>, penetration: S, _: S, _: &ContactMode<S>) -> NormalForce<S> {
        let elastic = law.stiffness * power(penetration, law.exponent);
        NormalForce {
            raw: elastic,
            elastic,
            excess: [S::zero(), S::one()],
        }
    }

    fn spring(law: &Hertz<S>) -> (S, S) {
        (law.stiffness, law.exponent)
    }

    fn carried_over(law: &Hertz<S>, factors: &Factors<S>) -> Hertz<S> {
        Hertz {
            stiffness: law.stiffness * factors.stiffness,
            exponent: law.exponent,
        }
    }
}
