//! Linear spring and damper side by side (Dubowsky and Freudenstein 1971): `F = K δ + D δ̇`.
//!
//! The force jumps by `D δ̇` at touch; the pull it would give on the way out is cut off.

use super::contact_law;
use super::factors::Factors;
use super::normal::{Normal, NormalForce};
use crate::lift::parameters;
use crate::mode::ContactMode;
use scalar::Scalar;

parameters! {
    /// Parameters of the linear law.
    pub struct KelvinVoigt<S> {
        /// Stiffness K, N/m.
        pub stiffness: S,
        /// Damping D, N s/m.
        pub damping: S,
    }
}

contact_law! {
    /// Linear spring and damper (Dubowsky and Freudenstein 1971).
    KelvinVoigt, stiffness "Stiffness, in N/m." {
        /// Damping.
        damping: Damping(FromZero);
    }
}

impl<S: Scalar> Normal<S> for Law {
    type Of = KelvinVoigt<S>;

    #[inline(always)]
    fn force(law: &KelvinVoigt<S>, penetration: S, rate: S, _: &ContactMode<S>) -> NormalForce<S> {
        let elastic = law.stiffness * penetration.max(S::zero());
        NormalForce::damped(elastic, law.damping * rate)
    }

    fn spring(law: &KelvinVoigt<S>) -> (S, S) {
        (law.stiffness, S::one())
    }

    fn carried_over(law: &KelvinVoigt<S>, factors: &Factors<S>) -> KelvinVoigt<S> {
        KelvinVoigt {
            stiffness: law.stiffness * factors.stiffness,
            damping: law.damping * factors.damping,
        }
    }
}
