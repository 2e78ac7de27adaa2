//! Linear spring and damper side by side (Dubowsky and Freudenstein 1971): `F = K δ + D δ̇`.
//!
//! The force jumps by `D δ̇` at touch; the pull it would give on the way out is cut off.

use super::NormalForce;
use crate::lift::parameters;
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

impl<S: Scalar> KelvinVoigt<S> {
    #[inline(always)]
    pub(super) fn force(&self, penetration: S, rate: S) -> NormalForce<S> {
        let elastic = self.stiffness * penetration.max(S::zero());
        NormalForce::damped(elastic, self.damping * rate)
    }
}
