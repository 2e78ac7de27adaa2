//! Misalignment of crosshead, piston rod and cylinder, or of the coupling: forces on the crosshead
//! with once and twice the speed, of one size at every speed and load (Sekhar and Prabhu 1995 find
//! 1× and 2×; Piotrowski 2006).
//!
//! ```text
//! F = F1 cos(α + φ1) + F2 cos(2 α + φ2)
//! ```
//!
//! along x, α since the throw's top dead centre. Signature: orders 1 and 2; their size stays when
//! speed and load change.

use super::{Acts, PistonAt};
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Forces of the misalignment.
    pub struct Misalignment<S> {
        /// Amplitude F1 once a revolution, N.
        pub first: S,
        /// Its phase φ1, rad.
        pub first_phase: S,
        /// Amplitude F2 twice a revolution, N.
        pub second: S,
        /// Its phase φ2, rad.
        pub second_phase: S,
    }
}

impl<S: Scalar> Acts<S> for Misalignment<S> {
    #[inline(always)]
    fn piston_force(&self, at: &PistonAt<S>) -> S {
        let (_, first) = (at.angle + self.first_phase).sin_cos();
        let (_, second) = (at.angle * 2.0 + self.second_phase).sin_cos();
        self.first * first + self.second * second
    }
}
