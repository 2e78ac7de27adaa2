//! The frame: a rigid mass on springs and dampers along x and y, shaken by the machine.
//!
//! ```text
//! M ẍ + C ẋ + K x (1 + q (x/10⁻⁴ m)²) = F(t)         along each direction
//! ```
//!
//! Mounts and bolts that come to bear harden, by q.
//!
//! F is all that the running gear puts on the frame: the main bearing's force, the guide's, and
//! the gas pressure on the cylinder's covers (which cancels the gas part of the bearing force).
//! The coupling is one-way: the frame's motion is taken as too small to act back.

use crate::lift::parameters;
use crate::plane::Vec2;
use integrate::Real;
use scalar::{Scalar, inlined};

/// Places, m, along x and y, and rates, m/s: as a state has them.
pub type FrameMotion = [f64; 4];

/// What a time makes of a place, m, and a rate, m/s, along an axis: their factors in the place then, and in the rate then.
pub type Swing = [[f64; 2]; 2];

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

impl<S: Real> Frame<S> {
    /// Whether its motions add up and free ones decay: where its springs do not harden and nothing is without damping.
    pub fn is_linear(&self) -> bool {
        let Self {
            stiffness_x,
            stiffness_y,
            damping_x,
            damping_y,
            ..
        } = self;
        let parts = [stiffness_x, stiffness_y, damping_x, damping_y];
        self.hardening.value() == 0.0 && parts.iter().all(|part| part.value() > 0.0)
    }
}

impl Frame<f64> {
    /// What `time` (s) makes of place and rate along x and along y where nothing shakes a frame that is linear.
    pub fn swing(&self, time: f64) -> [Swing; 2] {
        let along = |stiffness, damping| swing(stiffness / self.mass, damping / self.mass, time);
        [
            along(self.stiffness_x, self.damping_x),
            along(self.stiffness_y, self.damping_y),
        ]
    }
}

/// The free vibration ẍ + `damping` ẋ + `stiffness` x = 0 (Den Hartog 1985, Mechanical Vibrations, sections 2.3 and 2.4).
fn swing(stiffness: f64, damping: f64, time: f64) -> Swing {
    let decay = 0.5 * damping;
    let square = stiffness - decay * decay;
    let root = square.abs().sqrt();
    let (cosine, sine) = if square > 0.0 {
        let (sine, cosine) = Scalar::sin_cos(root * time);
        let left = Scalar::exp(-decay * time);
        (left * cosine, left * sine / root)
    } else {
        let slow = Scalar::exp((root - decay) * time);
        let fast: f64 = Scalar::exp(-2.0 * root * time);
        let sine = if root > 0.0 {
            0.5 * (1.0 - fast) / root
        } else {
            time
        };
        (slow * 0.5 * (1.0 + fast), slow * sine)
    };
    [
        [cosine + decay * sine, sine],
        [-stiffness * sine, cosine - decay * sine],
    ]
}
