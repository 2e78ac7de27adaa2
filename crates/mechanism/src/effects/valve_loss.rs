//! Pressure lost across open valves: quasi-steady orifice flow, so that the drop grows with the
//! square of the piston speed (Costagliola 1950, in the dimensionless form below).
//!
//! ```text
//! discharge valve open: p = pd (1 − ζd u |u| − λd u)      suction valve open: p = ps (1 − ζs u |u| − λs u)
//! ```
//!
//! u is the rate at which the chamber grows, as piston speed over the crank pin's speed R ω: below
//! 0 while gas flows out. λ is what a plate that a spring holds partly closed adds: its opening grows with the
//! flow, so that the drop grows less than with the square. Signature: the plateaus of the indicator diagram bulge at mid-stroke;
//! orders 2 to 6; dissipates work.

use super::acts::{Acts, ChamberAt};
use crate::declaration;
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of the valves, the same in every chamber.
    pub struct ValveLoss<S> {
        /// Loss coefficient ζs of the suction valve; plausible 0 to 0.5.
        pub suction: S,
        /// Loss coefficient ζd of the discharge valve; plausible 0 to 0.5.
        pub discharge: S,
        /// Part λs of the suction valve's loss that grows with the speed itself.
        pub suction_linear: S,
        /// Part λd of the discharge valve's loss that grows with the speed itself.
        pub discharge_linear: S,
    }
}

declaration! {
    /// Pressure drop over an open valve: line pressure × coefficient × (piston speed / crank-pin
    /// speed)².
    ValveLoss at [Throw, End], Gas:
    "The valves throttle the gas: while one is open, the pressure in the cylinder stays away from that of the line."
    law "line pressure × (1 ± ζ u²) while a valve is open, u the piston's speed over the crank pin's" after "Costagliola 1950" {
        /// Loss coefficient of the suction valve.
        suction: Number(FromZero), 0.002 to 0.5, start 0.1, absent 0.0;
        /// Loss coefficient of the discharge valve.
        discharge: Number(FromZero), 0.002 to 0.5, start 0.1, absent 0.0;
        /// The part of the suction valve's loss that grows with the speed itself; 0 where it is left out.
        @shape suction_linear: Number(FromZero), 0.0 to 0.15, start 0.0;
        /// The part of the discharge valve's loss that grows with the speed itself; 0 where it is left out.
        @shape discharge_linear: Number(FromZero), 0.0 to 0.15, start 0.0;
    } as ValveLoss
}

impl<S: Scalar> Acts<S> for ValveLoss<S> {
    #[inline(always)]
    fn line_pressures(&self, [suction, discharge]: [S; 2], at: &ChamberAt<S>) -> [S; 2] {
        let flow = at.growth * at.growth.abs();
        [
            suction * (S::one() - (self.suction * flow + self.suction_linear * at.growth)),
            discharge * (S::one() - (self.discharge * flow + self.discharge_linear * at.growth)),
        ]
    }
}
