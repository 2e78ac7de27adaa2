//! A bearing worn oval, or its journal: the clearance depends on the direction γ of contact in the
//! one that is oval,
//!
//! ```text
//! c(γ) = c + g (c2 cos 2(γ − γ0) + c3 cos 3(γ − γ3))          g = 1 + q (c/10⁻⁴ m − 1)
//! ```
//!
//! What wears a bearing widens it too: with q = 0 its form is that of one machine, with q = 1 it is a share of the clearance.
//!
//! In the bearings γ counts from the rod's axis (big and small end) or the frame's x (main bearing). In
//! the journals it counts from the crank pin's direction or the crosshead's x. The force is normal to
//! the oval surface. Form of the worn shell to second order (Dufrane, Kannel and McCloskey
//! 1983). Signature: reversals along the long axis are hard, across it soft; twice the angle.

use super::acts::{Acts, Shape};
use super::alternatives::{Alternatives, Oval};
use crate::declaration;
use crate::declaration::Clash;
use crate::lift::parameters;
use crate::plane::Vec2;
use scalar::Scalar;

/// Radial clearance at which the amplitudes are stated, m.
const REFERENCE: f64 = 1e-4;

parameters! {
    /// Parameters of the bearing.
    pub struct BearingOvality<S> {
        /// Amplitude c2, m.
        pub amplitude: S,
        /// Direction γ0 of the widest place, rad.
        pub direction: S,
        /// Amplitude c3 of three lobes, m.
        pub lobes: S,
        /// Direction γ3 of the first of them, rad.
        pub lobes_direction: S,
        /// Share q of both amplitudes that is in proportion to the clearance.
        pub growth: S,
        fixed {
            /// What is oval.
            pub oval: Oval,
        }
    }
}

declaration! {
    /// An oval bearing or journal: clearance + amplitude cos 2(direction of contact − direction).
    /// Nothing in an ideal joint.
    BearingOvality at [Throw, Joint, Part], Joint:
    "The bearing, or its journal, is worn oval: it has more play in one direction than in the other."
    law "c + c₂ cos 2(γ − γ₀), in the bearing or the journal (`part`)" after "Dufrane and others 1983" {
        /// By how much the clearance is larger in the widest direction and smaller across it.
        amplitude: Length(FromZero), 1e-6 to 2e-4, start 3e-5, absent 0.0;
        /// Widest direction, 0 deg where it is left out: in the bearing from the rod's axis (at the
        /// main bearing from the cylinder's), in the journal from the crank's direction (at the small
        /// end from the cylinder's).
        direction: Angle(Any), half_turn, start 0.0;
        /// By how much it is wider in each of three directions, a worn arc's next part; 0 mm where it is left out.
        @shape lobes: Length(FromZero), 0.0 to 3e-5, start 0.0;
        /// Direction of the first of the three, 0 deg where it is left out.
        @shape lobes_direction: Angle(Any), third_of_turn, start 0.0;
        /// Share of both amplitudes that is in proportion to the clearance, 0 to 1; they are then those of a radial clearance of
        /// 0.1 mm. 0 where it is left out.
        @shape growth: Number(FromZero), 0.0 to 1.0, start 0.0;
    }
}

/// The law with these values.
pub fn law(values: &[f64], alternatives: Alternatives) -> BearingOvality {
    let Values {
        amplitude,
        direction,
        lobes,
        lobes_direction,
        growth,
    } = Values::new(values);
    BearingOvality {
        amplitude,
        direction,
        lobes,
        lobes_direction,
        growth,
        oval: alternatives.part.unwrap_or(Oval::Bearing),
    }
}

impl BearingOvality {
    /// Refuses a joint of this clearance, m, in which the surfaces would meet all around.
    pub(super) fn check(&self, clearance: f64) -> Result<(), Clash> {
        match (self.amplitude + self.lobes) * self.grown(clearance) >= clearance {
            false => Ok(()),
            true => Err(Clash {
                key: "amplitude",
                expected: format!("a length below the clearance, {clearance} m"),
            }),
        }
    }
}

impl<S: Scalar> BearingOvality<S> {
    /// By what factor it is more out of round at this clearance, m, than at [`REFERENCE`].
    #[inline(always)]
    fn grown(&self, clearance: S) -> S {
        S::one() + self.growth * (clearance / REFERENCE - S::one())
    }
}

impl<S: Scalar> Acts<S> for BearingOvality<S> {
    #[inline(always)]
    fn shape(&self, bearing: Vec2<S>, journal: Vec2<S>, clearance: S) -> Option<Shape<S>> {
        let direction = match self.oval {
            Oval::Bearing => bearing,
            Oval::Journal => journal,
        };
        let (x, y) = (direction.x, direction.y);
        let [cosine, sine] = [x * x - y * y, x * y * 2.0];
        let (turn_sine, turn_cosine) = (self.direction * 2.0).sin_cos();
        let along = cosine * turn_cosine + sine * turn_sine;
        let across = sine * turn_cosine - cosine * turn_sine;
        // cos 3γ and sin 3γ from those of 2γ and γ.
        let [third_cosine, third_sine] = [cosine * x - sine * y, sine * x + cosine * y];
        let (turn_sine, turn_cosine) = (self.lobes_direction * 3.0).sin_cos();
        let third_along = third_cosine * turn_cosine + third_sine * turn_sine;
        let third_across = third_sine * turn_cosine - third_cosine * turn_sine;
        let grown = self.grown(clearance);
        let change = -grown * (self.amplitude * across * 2.0 + self.lobes * third_across * 3.0);
        Some(Shape {
            wider: grown * (self.amplitude * along + self.lobes * third_along),
            change: match self.oval {
                Oval::Bearing => [change, S::zero()],
                Oval::Journal => [S::zero(), change],
            },
        })
    }
}
