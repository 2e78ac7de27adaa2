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

use super::acts::{Acts, PistonAt};
use super::alternatives::{Alternatives, Shaken};
use crate::declaration;
use crate::lift::parameters;
use crate::plane::{Vec2, turned};
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

declaration! {
    /// An unbalance that turns with the crank and shakes the frame on soft mounts with the
    /// acceleration eccentricity × (speed of the crank)², which the sensor on the crosshead feels;
    /// or the crosshead alone, with that times its mass.
    RotatingUnbalance at [Body], Frame:
    "Something that turns with the crank is out of balance and shakes the machine once a revolution, with the square of the speed."
    law "frame accelerated by e θ̇² in the crank's direction + φ; or the crosshead alone (`body`)" after "ISO 21940-11" {
        /// Unbalance over the mass that it shakes.
        eccentricity: Length(FromZero), 1e-6 to 0.02, start 5e-4, absent 0.0;
        /// Angle by which it leads the crank; 0 deg where it is left out.
        phase: Angle(Any), turn, start 0.0;
    }
}

/// The law with these values.
pub fn law(values: &[f64], alternatives: Alternatives) -> RotatingUnbalance {
    let Values {
        eccentricity,
        phase,
    } = Values::new(values);
    RotatingUnbalance {
        eccentricity,
        phase,
        body: alternatives.body.unwrap_or(Shaken::Frame),
    }
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
        match self.body {
            Shaken::Frame => Some(self.acceleration(angle, speed)),
            Shaken::Crosshead => None,
        }
    }

    #[inline(always)]
    fn frame_motion(&self, angle: S, speed: S) -> Option<[Vec2<S>; 2]> {
        let (sine, cosine) = (angle + self.phase).sin_cos();
        let place = Vec2::new(cosine, sine) * -self.eccentricity;
        match self.body {
            Shaken::Frame => Some([place, turned(place) * speed]),
            Shaken::Crosshead => None,
        }
    }

    #[inline(always)]
    fn piston_force(&self, at: &PistonAt<S>) -> S {
        match self.body {
            Shaken::Frame => S::zero(),
            Shaken::Crosshead => self.acceleration(at.angle, at.crank_speed).x * at.mass,
        }
    }
}
