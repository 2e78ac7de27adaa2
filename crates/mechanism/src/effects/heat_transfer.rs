//! Heat between the gas and the walls of the cylinder: Newton's law of cooling. The film coefficient
//! follows the Reynolds analogy, h = St ρ cp w (Reynolds 1874). It is Woschni's of 1967 with exponents
//! of 1 in place of 0.8. For compressors see Adair, Qvale and Pearson 1972.
//!
//! ```text
//! d ln p / dt = m St w (A/V) (Tw/T − 1)     while both valves are closed
//! ```
//!
//! w is the mean piston speed, A/V = 2/x + 2/r the walls' area over the gas's volume, T its
//! temperature from p V = const T. It is the first law, Q̇ = h A (Tw − T) = p V/(m − 1) d ln p/dt, with
//! cp/R = m/(m − 1). Signature: slopes of the polytropes that are not one exponent; other walls.

use super::acts::{Acts, ChamberAt};
use crate::declaration;
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of the heat transfer.
    pub struct HeatTransfer<S> {
        /// Stanton number St.
        pub stanton: S,
        /// Temperature of the walls over that of the gas in the suction line.
        pub wall_temperature: S,
    }
}

declaration! {
    /// Heat transfer between the gas and the walls of the cylinder by a Stanton number.
    HeatTransfer at [Throw, End], Gas:
    "The cylinder walls heat the cool gas and cool the hot gas, so that its pressure leaves the curve of the exponent."
    law "d ln p/dt = m St w (A/V) (T_w/T − 1)" after "Reynolds 1874, Woschni 1967" {
        /// Stanton number: heat that the walls take up over the heat that flows past them.
        stanton: Number(FromZero), 0.0002 to 0.1, start 0.01, absent 0.0;
        /// Temperature of the walls over that of the gas in the suction line; 1.2 where it is left
        /// out.
        wall_temperature: Number(AboveZero), 0.9 to 1.6, start 1.2;
    } as HeatTransfer
}

impl<S: Scalar> Acts<S> for HeatTransfer<S> {
    #[inline(always)]
    fn drifts(&self) -> bool {
        true
    }

    #[inline(always)]
    fn drift(&self, at: &ChamberAt<S>) -> S {
        let walls = (S::one() / at.distance + S::one() / at.radius) * 2.0;
        let excess = self.wall_temperature / at.warmth - 1.0;
        at.exponent * self.stanton * at.mean_speed * walls * excess
    }
}
