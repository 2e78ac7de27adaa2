//! Misalignment of crosshead, piston rod and cylinder, or of the coupling. It exerts forces on the
//! crosshead with once and twice the speed, of one size at every speed and load. Sources: Sekhar and
//! Prabhu 1995 find 1× and 2×; Piotrowski 2006.
//!
//! ```text
//! F = F1 cos(α + φ1) + F2 cos(2 α + φ2)
//! ```
//!
//! along x, α since the throw's top dead centre. Signature: orders 1 and 2; their size stays when
//! speed and load change.

use super::acts::{Acts, PistonAt};
use crate::declaration;
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

declaration! {
    /// Forces on the crosshead along the cylinder, once and twice a revolution.
    Misalignment at [Throw], RunningGear:
    "Crosshead, piston rod and cylinder are not in line: they bind once or twice a revolution, at every speed alike."
    law "force F₁ cos(α + φ₁) + F₂ cos(2α + φ₂) on the crosshead" after "Piotrowski 2006" {
        /// Amplitude of the force once a revolution.
        first: Force(FromZero), 1.0 to 5000.0, start 200.0, absent 0.0;
        /// Its phase at top dead centre; 0 deg where it is left out.
        first_phase: Angle(Any), turn, start 0.0;
        /// Amplitude of the force twice a revolution.
        second: Force(FromZero), 1.0 to 5000.0, start 200.0, absent 0.0;
        /// Its phase at top dead centre; 0 deg where it is left out.
        second_phase: Angle(Any), turn, start 0.0;
    } as Misalignment
}

impl<S: Scalar> Acts<S> for Misalignment<S> {
    #[inline(always)]
    fn piston_force(&self, at: &PistonAt<S>) -> S {
        let (_, first) = (at.angle + self.first_phase).sin_cos();
        let (_, second) = (at.angle * 2.0 + self.second_phase).sin_cos();
        self.first * first + self.second * second
    }
}
