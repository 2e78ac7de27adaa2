//! Suction valve that closes late: held open by an unloader, sticking, or with a weak spring, until
//! the crank has passed the dead centre by an angle. The gas flows back into the suction line, and
//! the compression starts from what volume is left (Bloch and Hoefner 1996, Reciprocating
//! Compressors, on stepless capacity control).
//!
//! ```text
//! compression: p = max(ps, ps (x_c / x)^m)      x_c: distance from piston to cover at the angle
//! ```
//!
//! Signature: the compression line starts late and rises more steeply, the discharge opens later,
//! less gas is delivered; the same crank angle at every speed. Where the compression no longer
//! reaches the discharge pressure, the expansion starts from what it has reached.

use super::Acts;
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of a held suction valve.
    pub struct SuctionUnloading<S> {
        /// Crank angle after the chamber's dead centre at which the valve closes, rad.
        pub held: S,
    }
}

impl<S: Scalar> Acts<S> for SuctionUnloading<S> {
    fn suction_held(&self) -> Option<S> {
        Some(self.held)
    }

    fn drifts(&self) -> bool {
        true
    }
}
