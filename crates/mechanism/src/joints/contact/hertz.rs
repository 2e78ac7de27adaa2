//! Hertz 1881: `F = K δⁿ` (n = 3/2 for point contact), without dissipation.

use super::{NormalForce, power};
use crate::lift::parameters;
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

impl<S: Scalar> Hertz<S> {
    #[inline(always)]
    pub(super) fn force(&self, penetration: S) -> NormalForce<S> {
        let elastic = self.stiffness * power(penetration, self.exponent);
        NormalForce {
            raw: elastic,
            elastic,
            excess: [S::zero(), S::one()],
        }
    }
}
