//! Suction valve that closes late: held open by an unloader, sticking, or with a weak spring, until
//! the crank has passed the dead centre by an angle. The gas flows back into the suction line, and
//! the compression starts from what volume is left (Bloch and Hoefner 1996, Reciprocating
//! Compressors, on stepless capacity control). What holds the valve also throttles it, on the way in
//! and on the way back: quasi-steady orifice flow, as in [`ValveLoss`](super::ValveLoss).
//!
//! ```text
//! valve open:  p = ps (1 − ζ u |u|)
//! compression: p = max(that, ps (x_c / x)^m)      x_c: distance from piston to cover at the angle
//! ```
//!
//! u is the rate at which the chamber grows, as piston speed over the crank pin's. The angle is where
//! the line of compression, drawn back, leaves the suction pressure; with a loss the valve closes some
//! degrees later, at a higher pressure. Signature: the compression line starts late and rises more
//! steeply, the discharge opens later, less gas is delivered; the same crank angle at every speed.
//! Where the compression no longer reaches the discharge pressure, the expansion starts from what it
//! has reached.

use super::acts::{Acts, ChamberAt};
use crate::declaration;
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of a held suction valve.
    pub struct SuctionUnloading<S> {
        /// Crank angle after the chamber's dead centre at which the valve closes, rad.
        pub held: S,
        /// Loss coefficient ζ of the held valve; plausible 0 to 0.5.
        pub loss: S,
    }
}

declaration! {
    /// Suction valve held open into the compression stroke: gas flows back into the suction line.
    SuctionUnloading at [Throw, End], Gas, PerEnd includes valve_loss.suction:
    "The suction valve closes late, or is held open: part of the gas is pushed back before the compression starts."
    law "suction valve open until an angle after the dead centre, throttling by ζ u²; the rest is compressed" after "Bloch and Hoefner 1996" {
        /// Crank angle after the dead centre at which the valve closes.
        held: Angle(OnTheStroke), 0.02 to 3.1, start 0.5, absent 0.0;
        /// Loss coefficient of the valve while it is held; 0 where it is left out.
        loss: Number(FromZero), 0.002 to 0.5, start 0.05, absent 0.0;
    } as SuctionUnloading
}

impl<S: Scalar> Acts<S> for SuctionUnloading<S> {
    #[inline(always)]
    fn line_pressures(&self, [suction, discharge]: [S; 2], at: &ChamberAt<S>) -> [S; 2] {
        let flow = at.growth * at.growth.abs();
        [suction * (S::one() - self.loss * flow), discharge]
    }

    #[inline(always)]
    fn suction_held(&self) -> Option<S> {
        Some(self.held)
    }

    #[inline(always)]
    fn drifts(&self) -> bool {
        true
    }
}
