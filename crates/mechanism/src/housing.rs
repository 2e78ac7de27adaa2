//! The housing of a throw's crosshead guide, with distance piece and cylinder: a mass on a spring and a damper along
//! x and along y, that stands on the frame.
//!
//! ```text
//! m z̈ + 2 ζ ω m ż + ω² m z = F − m ẍ_f          z = x_h − x_f, along each direction
//! ẍ_h = s²/(s² + 2 ζ ω s + ω²) · (F/m + 2 ζ ω ẋ_f + ω² x_f)
//! ```
//!
//! x_h is the place of the housing, x_f that of the frame. F is what the throw puts on the housing: the force of the
//! crosshead on its guide, the gas on the cylinder's covers and the friction of the piston's rings. The second line is
//! the first one for x_h: the transmissibility from the frame and the accelerance of the force together
//! (Harris and Piersol 2002, chapter 2). The coupling is one-way: machine and frame move as if the housing were rigid.
//! What stands in brackets is found here, at an instant. The oscillator's response to it is a sensor's.

use crate::lift::parameters;
use crate::plane::Vec2;
use scalar::Scalar;

parameters! {
    /// A mass on a spring and a damper along each direction.
    pub struct Housing<S> {
        /// Effective mass m, kg.
        pub mass: S,
        /// How it swings along x.
        pub x: Swing<S>,
        /// How it swings along y.
        pub y: Swing<S>,
    }
}

parameters! {
    /// How a mass swings in one direction.
    pub struct Swing<S> {
        /// Natural frequency ω without damping, rad/s.
        pub frequency: S,
        /// Damping ratio ζ.
        pub damping_ratio: S,
    }
}

impl<S: Scalar> Housing<S> {
    /// What drives the housing, m/s²: the `force` on it, N, and the frame at `place`, m, and `rate`, m/s.
    #[inline(always)]
    pub(crate) fn drive(&self, force: Vec2<S>, [place, rate]: [Vec2<S>; 2]) -> Vec2<S> {
        Vec2::new(
            force.x / self.mass + self.x.drive(place.x, rate.x),
            force.y / self.mass + self.y.drive(place.y, rate.y),
        )
    }
}

impl<S: Scalar> Swing<S> {
    /// What the frame adds through spring and damper, m/s².
    #[inline(always)]
    fn drive(&self, place: S, rate: S) -> S {
        self.frequency * (self.frequency * place + self.damping_ratio * rate * 2.0)
    }
}
