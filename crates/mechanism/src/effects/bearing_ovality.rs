//! A bearing worn oval, or its journal: the clearance depends on the direction γ of contact in the
//! one that is oval,
//!
//! ```text
//! c(γ) = c + c2 cos 2(γ − γ0)
//! ```
//!
//! γ counts from the rod's axis in the bearings of big and small end and from the frame's x in the
//! main bearing; in the journals from the crank pin's direction and from the crosshead's x. The force
//! stands on the oval surface. Form of the worn shell to second order (Dufrane, Kannel and McCloskey
//! 1983). Signature: reversals along the long axis are hard, across it soft; twice the angle.

use super::{Acts, Shape};
use crate::lift::parameters;
use crate::plane::Vec2;
use scalar::Scalar;

parameters! {
    /// Parameters of the bearing.
    pub struct BearingOvality<S> {
        /// Amplitude c2, m.
        pub amplitude: S,
        /// Direction γ0 of the widest place, rad.
        pub direction: S,
        fixed {
            /// What is oval.
            pub oval: Oval,
        }
    }
}

/// What is oval in a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Oval {
    /// The bearing.
    Bearing,
    /// The journal.
    Journal,
}

impl<S: Scalar> Acts<S> for BearingOvality<S> {
    #[inline(always)]
    fn shape(&self, bearing: Vec2<S>, journal: Vec2<S>) -> Option<Shape<S>> {
        let direction = match self.oval {
            Oval::Bearing => bearing,
            Oval::Journal => journal,
        };
        let (x, y) = (direction.x, direction.y);
        let [cosine, sine] = [x * x - y * y, x * y * 2.0];
        let (turn_sine, turn_cosine) = (self.direction * 2.0).sin_cos();
        let along = cosine * turn_cosine + sine * turn_sine;
        let across = sine * turn_cosine - cosine * turn_sine;
        let change = -(self.amplitude * across * 2.0);
        Some(Shape {
            wider: self.amplitude * along,
            change: match self.oval {
                Oval::Bearing => [change, S::zero()],
                Oval::Journal => [S::zero(), change],
            },
        })
    }
}
