//! Ambrósio 2003: Coulomb's law with a dynamic correction that fades the force out at low speed.
//!
//! ```text
//! μ(v) = cd μ sgn(v),   cd = clamp((|v| − v0)/(v1 − v0), 0, 1)
//! ```

use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of Ambrósio's law.
    pub struct Ambrosio<S> {
        /// Coefficient μ.
        pub coefficient: S,
        /// Slip speed v0 up to which there is no friction, m/s.
        pub slow: S,
        /// Slip speed v1 > v0 from which it is full, m/s.
        pub fast: S,
    }
}

impl<S: Scalar> Ambrosio<S> {
    #[inline(always)]
    pub(super) fn coefficient(&self, slip: S) -> S {
        let share = ((slip.abs() - self.slow) / (self.fast - self.slow)).clamp(S::zero(), S::one());
        let full = self.coefficient * share;
        S::select(slip.lt(S::zero()), -full, full)
    }
}
