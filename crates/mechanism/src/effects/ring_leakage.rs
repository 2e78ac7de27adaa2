//! Gas that leaks past the piston rings to the other side of the piston. The rings are throttles in
//! series, for which Stodola's ellipse holds (Stodola 1927, Steam and Gas Turbines, labyrinths):
//!
//! ```text
//! ṁ = A √((p1² − p2²) / (R T))         d ln p / dt = −n ṁ R T / (p V)     while both valves are closed
//! ```
//!
//! A is the area of one throttle over the root of their number, with its discharge coefficient, R T
//! the square of `gas_speed`, taken where the gas comes from as in the suction line. The second
//! equation is the first law for a chamber that loses gas of its own state. At equal pressures the
//! root is smoothed over 2 % of the suction pressure. One throttle alone, whose flow chokes, and a narrow
//! gap have other laws ([`ChamberAt::leaks_to`]). Under the piston of a single-acting cylinder no less than `behind` is left. Near a dead centre gas may leak faster than the piston
//! compresses; then the suction valve stays open (`gas`). Signature: compression too low, expansion too
//! steep; the slower the machine the more; as a polytrope with other exponents, but for its speed.

use super::acts::{Acts, ChamberAt, Gap};
use crate::declaration;
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of leaking rings.
    pub struct RingLeakage<S> {
        /// Effective area A, m².
        pub area: S,
        /// √(R T) of the gas in the suction line, m/s; 290 for air.
        pub gas_speed: S,
        /// Ratio of the pressures below which the gas flows no faster.
        pub critical_ratio: S,
        /// Share of the flow that is laminar.
        pub laminar: S,
        /// Pressure below which that behind the rings does not fall, Pa.
        pub behind: S,
    }
}

declaration! {
    /// Leakage past the piston rings, as through throttles in series: flow = area × root of the
    /// difference of the squares of the pressures / gas_speed.
    RingLeakage at [Throw, End], Gas:
    "The piston rings leak: gas escapes to the other side of the piston, so that the pressure rises too slowly and falls too fast."
    law "flow = A √((p₁² − p₂²)/RT) to the other side of the piston" after "Stodola 1927" {
        /// Effective area: that of the gap over the root of the number of rings.
        area: Area(FromZero), 1e-8 to 3e-4, start 5e-6, absent 0.0;
        /// Root of gas constant times temperature in the suction line; 290 m/s, as for air, where it
        /// is left out.
        gas_speed: Velocity(AboveZero), 150.0 to 500.0, start 290.0;
        /// Ratio of the pressures below which the gas flows no faster: 0, as for many throttles in series, where it is left out;
        /// 0.53 for one orifice and air.
        @shape critical_ratio: Number(FromZero), 0.0 to 0.6, start 0.0;
        /// Share of the flow that is laminar, as in a narrow gap, 0 to 1; 0 where it is left out.
        @shape laminar: Number(FromZero), 0.0 to 1.0, start 0.0;
        /// Pressure below which that behind the rings does not fall, as of a crankcase that breathes; 0 Pa where it is left out: the
        /// pressure on the other side of the piston, which data sheets of single-acting cylinders seldom state.
        @shape behind: Pressure(FromZero), 0.0 to 2e5, start 0.0, other 101_325.0;
    } as RingLeakage
}

impl<S: Scalar> Acts<S> for RingLeakage<S> {
    #[inline(always)]
    fn drifts(&self) -> bool {
        true
    }

    #[inline(always)]
    fn drift(&self, at: &ChamberAt<S>) -> S {
        let gap = Gap {
            critical_ratio: self.critical_ratio,
            laminar: self.laminar,
        };
        -(self.area * self.gas_speed * at.leaks_to(at.across.max(self.behind), gap)) * at.loss_of_flow()
    }
}
