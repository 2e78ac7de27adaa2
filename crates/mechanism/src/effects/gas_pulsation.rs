//! Pulsation: the pressures of the lines swing with a harmonic of the crank, as in a pipe whose
//! resonance it meets (API 618; the first term of the series that an acoustic study gives).
//!
//! ```text
//! line = mean (1 + b cos(k α + φ))
//! ```
//!
//! α is the crank angle since the throw's top dead centre. Signature: plateaus that wobble, with
//! the order k; the same share at every pressure, strongest where k times the speed meets a resonance.

use super::acts::{Acts, ChamberAt};
use crate::declaration;
use crate::lift::parameters;
use scalar::{Scalar, inlined};

parameters! {
    /// One harmonic of the pressures in the lines.
    pub struct GasPulsation<S> {
        /// Its order k, cycles a revolution.
        pub order: S,
        /// Amplitude b in the suction line, over its pressure.
        pub suction: S,
        /// Its phase φ, rad.
        pub suction_phase: S,
        /// Amplitude b in the discharge line, over its pressure.
        pub discharge: S,
        /// Its phase φ, rad.
        pub discharge_phase: S,
    }
}

declaration! {
    /// A harmonic of the line pressures: pressure × (1 + amplitude cos(order × crank angle + phase)).
    GasPulsation at [Throw, End], Gas:
    "The pressure in the pipes pulsates: while a valve is open, the cylinder's pressure swings with the line."
    law "line pressure × (1 + b cos(k α + φ))" after "API 618" {
        /// Cycles a revolution; 2 where it is left out.
        order: Number(Whole(1, 24)), 1.0 to 8.0, start 2.0;
        /// Amplitude in the suction line, of its pressure.
        suction: Ratio(FromZero), 0.001 to 0.2, start 0.02, absent 0.0;
        /// Its phase; 0 deg where it is left out.
        suction_phase: Angle(Any), turn, start 0.0;
        /// Amplitude in the discharge line, of its pressure.
        discharge: Ratio(FromZero), 0.001 to 0.2, start 0.02, absent 0.0;
        /// Its phase; 0 deg where it is left out.
        discharge_phase: Angle(Any), turn, start 0.0;
    } as GasPulsation
}

impl<S: Scalar> Acts<S> for GasPulsation<S> {
    #[inline(always)]
    fn line_pressures(&self, [suction, discharge]: [S; 2], at: &ChamberAt<S>) -> [S; 2] {
        let swing = inlined(#[inline(always)] |amplitude: S, phase: S| {
            let (_, cosine) = (self.order * at.angle + phase).sin_cos();
            S::one() + amplitude * cosine
        });
        [
            suction * swing(self.suction, self.suction_phase),
            discharge * swing(self.discharge, self.discharge_phase),
        ]
    }
}
