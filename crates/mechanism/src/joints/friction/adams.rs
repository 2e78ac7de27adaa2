//! Coulomb friction as ADAMS has it: from 0 the coefficient rises to the static one at the
//! stiction speed vs, and falls to the dynamic one at the transition speed vd, by cubic steps.
//!
//! ```text
//! |v| ≤ vs        μ = STEP(v, −vs, −μs, vs, μs)
//! vs < |v| < vd   μ = sgn(v) STEP(|v|, vs, μs, vd, μd)
//! vd ≤ |v|        μ = sgn(v) μd
//! ```
//!
//! Below vs the surfaces creep: there is no true sticking.

use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of the ADAMS law.
    pub struct Adams<S> {
        /// Static coefficient μs.
        pub static_coefficient: S,
        /// Dynamic coefficient μd.
        pub dynamic_coefficient: S,
        /// Stiction speed vs, m/s.
        pub stiction_speed: S,
        /// Friction transition speed vd > vs, m/s.
        pub transition_speed: S,
    }
}

impl<S: Scalar> Adams<S> {
    #[inline(always)]
    pub(super) fn coefficient(&self, slip: S) -> S {
        let (low, high) = (self.stiction_speed, self.transition_speed);
        let (still, moving) = (self.static_coefficient, self.dynamic_coefficient);
        let speed = slip.abs();
        let creeping = speed.lt(low);
        let pick = |rising, falling| S::select(creeping, rising, falling);
        let size = step(
            pick(slip, speed),
            pick(-low, low),
            pick(-still, still),
            pick(low, high),
            pick(still, moving),
        );
        let backward = slip.lt(S::zero());
        S::select(creeping, size, S::select(backward, -size, size))
    }
}

/// The STEP function of ADAMS: a cubic from (x0, h0) to (x1, h1), level outside.
#[inline(always)]
fn step<S: Scalar>(x: S, x0: S, h0: S, x1: S, h1: S) -> S {
    let u = ((x - x0) / (x1 - x0)).clamp(S::zero(), S::one());
    h0 + (h1 - h0) * u * u * (S::constant(3.0) - u - u)
}
