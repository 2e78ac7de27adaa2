//! A rotating mass out of centre: a force m r θ̇² that turns with the crank (ISO 21940-11).
//!
//! Over the mass of all that the mounts carry it is e θ̇², with the specific unbalance e by which
//! that standard grades rotors. On mounts that are soft against the speed the frame moves with
//!
//! ```text
//! a = e θ̇² (cos(θ + φ), sin(θ + φ))
//! ```
//!
//! and everything on it feels −a like gravity, while a sensor on the crosshead reads the crosshead's
//! acceleration in the frame and a. Where the frame is held fast, the force can still reach the
//! crosshead through its guide: m e θ̇² cos(α + φ), with the mass m of the crosshead. Signature:
//! order 1, the square of the speed, no load.

use super::{Acts, PistonAt};
use crate::lift::parameters;
use crate::plane::Vec2;
use scalar::Scalar;

parameters! {
    /// Parameters of the unbalance.
    pub struct RotatingUnbalance<S> {
        /// Specific unbalance e, m.
        pub eccentricity: S,
        /// Angle φ by which it leads the crank, rad.
        pub phase: S,
        fixed {
            /// What it shakes.
            pub body: Shaken,
        }
    }
}

/// What an unbalance shakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shaken {
    /// The frame with everything on it.
    Frame,
    /// The crosshead along its guide.
    Crosshead,
}

impl<S: Scalar> RotatingUnbalance<S> {
    #[inline(always)]
    fn acceleration(&self, angle: S, speed: S) -> Vec2<S> {
        let (sine, cosine) = (angle + self.phase).sin_cos();
        Vec2::new(cosine, sine) * (self.eccentricity * speed * speed)
    }
}

impl<S: Scalar> Acts<S> for RotatingUnbalance<S> {
    #[inline(always)]
    fn frame_acceleration(&self, angle: S, speed: S) -> Option<Vec2<S>> {
        (self.body == Shaken::Frame).then(|| self.acceleration(angle, speed))
    }

    #[inline(always)]
    fn piston_force(&self, at: &PistonAt<S>) -> S {
        match self.body {
            Shaken::Frame => S::zero(),
            Shaken::Crosshead => self.acceleration(at.angle, at.crank_speed).x * at.mass,
        }
    }
}
