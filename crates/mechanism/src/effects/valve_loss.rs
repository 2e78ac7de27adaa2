//! Pressure lost across open valves: quasi-steady orifice flow, so that the drop grows with the
//! square of the piston speed (Costagliola 1950, in the dimensionless form below).
//!
//! ```text
//! discharge valve open: p = pd (1 − ζd u |u|)      suction valve open: p = ps (1 − ζs u |u|)
//! ```
//!
//! u is the rate at which the chamber grows, as piston speed over the crank pin's speed R ω: below
//! 0 while gas flows out. Signature: the plateaus of the indicator diagram bulge at mid-stroke;
//! orders 2 to 6; dissipates work.

use super::{Acts, ChamberAt};
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of the valves, the same in every chamber.
    pub struct ValveLoss<S> {
        /// Loss coefficient ζs of the suction valve; plausible 0 to 0.5.
        pub suction: S,
        /// Loss coefficient ζd of the discharge valve; plausible 0 to 0.5.
        pub discharge: S,
    }
}

impl<S: Scalar> Acts<S> for ValveLoss<S> {
    #[inline(always)]
    fn line_pressures(&self, [suction, discharge]: [S; 2], at: &ChamberAt<S>) -> [S; 2] {
        let flow = at.growth * at.growth.abs();
        [
            suction * (S::one() - self.suction * flow),
            discharge * (S::one() - self.discharge * flow),
        ]
    }
}
