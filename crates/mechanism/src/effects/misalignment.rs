//! Misalignment of crosshead, piston rod and cylinder, or of the coupling. It exerts forces on the
//! crosshead with once and twice the speed, some with three times. Sources: Sekhar and Prabhu 1995 find 1× and 2×;
//! Piotrowski 2006 also 3×.
//!
//! ```text
//! F = (F1 cos(α + φ1) + F2 cos(2 α + φ2) + F3 cos(3 α + φ3)) (p_d / 1 MPa)^n
//! ```
//!
//! along x, α since the throw's top dead centre, p_d the discharge pressure. A running gear that is out of line by itself
//! has n = 0, one that the load of the rod bends out of it n = 1. Signature: orders 1 to 3; their size stays when the speed
//! changes.

use super::acts::{Acts, PistonAt};
use crate::declaration;
use crate::lift::parameters;
use scalar::Scalar;

/// Discharge pressure at which forces that grow with it are stated, Pa.
const LOAD: f64 = 1e6;

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
        /// Amplitude F3 three times a revolution, N.
        pub third: S,
        /// Its phase φ3, rad.
        pub third_phase: S,
        /// Exponent n of the discharge pressure.
        pub load_exponent: S,
    }
}

declaration! {
    /// Forces on the crosshead along the cylinder, once and twice a revolution.
    Misalignment at [Throw], RunningGear:
    "Crosshead, piston rod and cylinder are not in line: they bind once or twice a revolution, at every speed alike."
    law "force Σ Fₖ cos(kα + φₖ) on the crosshead, k = 1, 2, 3" after "Piotrowski 2006" {
        /// Amplitude of the force once a revolution.
        first: Force(FromZero), 1.0 to 5000.0, start 200.0, absent 0.0;
        /// Its phase at top dead centre; 0 deg where it is left out.
        first_phase: Angle(Any), turn, start 0.0;
        /// Amplitude of the force twice a revolution.
        second: Force(FromZero), 1.0 to 5000.0, start 200.0, absent 0.0;
        /// Its phase at top dead centre; 0 deg where it is left out.
        second_phase: Angle(Any), turn, start 0.0;
        /// Amplitude of the force three times a revolution; 0 N where it is left out.
        @shape third: Force(FromZero), 0.0 to 5000.0, start 0.0;
        /// Its phase at top dead centre; 0 deg where it is left out.
        @shape third_phase: Angle(Any), turn, start 0.0;
        /// Exponent of the discharge pressure in MPa that the forces grow with: 0, where it is left out, for forces of one
        /// size, 1 for those that grow with the load.
        @shape load_exponent: Number(FromZero), 0.0 to 1.0, start 0.0;
    } as Misalignment
}

impl<S: Scalar> Acts<S> for Misalignment<S> {
    #[inline(always)]
    fn piston_force(&self, at: &PistonAt<S>) -> S {
        let (_, first) = (at.angle + self.first_phase).sin_cos();
        let (_, second) = (at.angle * 2.0 + self.second_phase).sin_cos();
        let (_, third) = (at.angle * 3.0 + self.third_phase).sin_cos();
        let load = (at.discharge * (1.0 / LOAD)).powf(self.load_exponent);
        (self.first * first + self.second * second + self.third * third) * load
    }
}
