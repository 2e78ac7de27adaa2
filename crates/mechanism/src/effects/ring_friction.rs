//! Friction of piston rings and packing on the crosshead body: a constant part from the rings'
//! tension and a part that the gas pressure behind the rings adds (Rezeka and Henein 1984 keep
//! the same two).
//!
//! ```text
//! F = −(F0 + b p) v / √(v² + vs²)
//! ```
//!
//! Signature: a step at both dead centres, odd orders; grows with pressure, not with speed.

use super::{Acts, PistonAt};
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of the rings.
    pub struct RingFriction<S> {
        /// Friction F0 without pressure, N; plausible 0 to 5 % of the piston's gas load.
        pub coulomb_force: S,
        /// Friction b per head-end pressure, N/Pa.
        pub per_pressure: S,
        /// Speed vs over which the sign change is spread, m/s.
        pub slip_speed: S,
    }
}

impl<S: Scalar> Acts<S> for RingFriction<S> {
    #[inline(always)]
    fn piston_force(&self, at: &PistonAt<S>) -> S {
        let (speed, slip) = (at.speed, self.slip_speed);
        let size = self.coulomb_force + self.per_pressure * at.pressure;
        -(size * speed) / (speed * speed + slip * slip).sqrt()
    }
}
