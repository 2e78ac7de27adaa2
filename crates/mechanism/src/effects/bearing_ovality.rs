//! A bearing worn oval: its clearance depends on the direction γ in the bearing,
//!
//! ```text
//! c(γ) = c + c2 cos 2(γ − γ0)
//! ```
//!
//! γ counts from the rod's axis (big and small end; from the frame's x at the main bearing). The
//! contact force stands on the oval surface. Form of the shell after Dufrane et al. 1983 to second
//! order. Signature: reversals along the long axis are hard, across it soft; twice the angle.

use super::Acts;
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
    }
}

impl<S: Scalar> Acts<S> for BearingOvality<S> {
    fn bearing_shape(&self, direction: Vec2<S>) -> Option<[S; 2]> {
        let (x, y) = (direction.x, direction.y);
        let [cosine, sine] = [x * x - y * y, x * y * 2.0];
        let (turn_sine, turn_cosine) = (self.direction * 2.0).sin_cos();
        let along = cosine * turn_cosine + sine * turn_sine;
        let across = sine * turn_cosine - cosine * turn_sine;
        Some([self.amplitude * along, -(self.amplitude * across * 2.0)])
    }
}
