//! The frame: a rigid mass on springs and dampers along x and y, shaken by the machine.
//!
//! ```text
//! M ẍ + C ẋ + K x (1 + q (x/10⁻⁴ m)²) = F(t)         along each direction
//! ```
//!
//! Mounts and bolts that come to bear harden, by q.//!
//! F is all that the running gear puts on the frame: the main bearing's force, the guide's, and
//! the gas pressure on the cylinder's covers (which cancels the gas part of the bearing force).
//! The coupling is one-way: the frame's motion is taken as too small to act back.

use crate::lift::parameters;
use crate::plane::Vec2;
use scalar::{Scalar, inlined};

/// Displacement at which the hardening of the springs is stated, m.
const STATED_AT: f64 = 1e-4;

parameters! {
    /// An elastically mounted frame.
    pub struct Frame<S> {
        /// Mass, kg.
        pub mass: S,
        /// Stiffness along x, N/m.
        pub stiffness_x: S,
        /// Stiffness along y, N/m.
        pub stiffness_y: S,
        /// Damping along x, N s/m.
        pub damping_x: S,
        /// Damping along y, N s/m.
        pub damping_y: S,
        /// By what share q the springs are stiffer at [`STATED_AT`].
        pub hardening: S,
        fixed {
            /// True where sensors on the crossheads feel the frame's motion.
            pub carries: bool,
        }
    }
}

impl<S: Scalar> Frame<S> {
    /// Acceleration under `force` (N) at displacement `place` (m) and `rate` (m/s), m/s².
    #[inline(always)]
    pub(crate) fn acceleration(&self, force: Vec2<S>, place: Vec2<S>, rate: Vec2<S>) -> Vec2<S> {
        let hardened = inlined(
            #[inline(always)]
            |stiffness: S, place: S| {
                let strain = place / STATED_AT;
                stiffness * (S::one() + self.hardening * strain * strain)
            },
        );
        let net = Vec2::new(
            force.x - hardened(self.stiffness_x, place.x) * place.x - self.damping_x * rate.x,
            force.y - hardened(self.stiffness_y, place.y) * place.y - self.damping_y * rate.y,
        );
        net / self.mass
    }
}
