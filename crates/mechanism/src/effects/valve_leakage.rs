//! Valves that leak: gas of the chamber flows back to the suction line, gas of the discharge line into the chamber. A gap
//! at a broken plate or a worn seat is a throttle, for which Stodola's ellipse holds (Stodola 1927, Steam and Gas Turbines):
//!
//! ```text
//! ṁ = A √((p² − p_line²) / (R T))         d ln p / dt = −n ṁ R T / (p V)     while both valves are closed
//! ```
//!
//! A is an effective area, with its discharge coefficient, R T the square of `gas_speed`, as of gas in the suction line. A gap whose
//! flow chokes, and a narrow one, have other laws ([`ChamberAt::leaks_to`]).
//! Signature: a suction valve that leaks lets the pressure rise too slowly and fall too fast, a discharge valve
//! that leaks the other way round; both the more the slower the machine.

use super::acts::{Acts, ChamberAt, Gap};
use crate::declaration;
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of leaking valves.
    pub struct ValveLeakage<S> {
        /// Effective area of the gap at the suction valve, m².
        pub suction: S,
        /// The same at the discharge valve, m².
        pub discharge: S,
        /// √(R T) of the gas in the suction line, m/s; 290 for air.
        pub gas_speed: S,
        /// Ratio of the pressures below which the gas flows no faster.
        pub critical_ratio: S,
        /// Share of the flow that is laminar.
        pub laminar: S,
    }
}

declaration! {
    /// Leakage through closed valves, as through throttles: flow = area × root of the difference of the squares of the
    /// pressures of chamber and line / gas_speed.
    ValveLeakage at [Throw, End], Gas:
    "A valve leaks while it is closed: gas of the cylinder flows back to the suction line, or gas of the discharge line into the cylinder."
    law "flow = A √((p² − p_line²)/RT) to the line" after "Stodola 1927" {
        /// Effective area of the gap at the suction valve.
        suction: Area(FromZero), 1e-8 to 3e-4, start 5e-6, absent 0.0;
        /// Effective area of the gap at the discharge valve.
        discharge: Area(FromZero), 1e-8 to 3e-4, start 5e-6, absent 0.0;
        /// Root of gas constant times temperature in the suction line; 290 m/s, as for air, where it
        /// is left out.
        gas_speed: Velocity(AboveZero), 150.0 to 500.0, start 290.0;
        /// Ratio of the pressures below which the gas flows no faster: 0, as for many throttles in series, where it is left out;
        /// 0.53 for one orifice and air.
        @shape critical_ratio: Number(FromZero), 0.0 to 0.6, start 0.0;
        /// Share of the flow that is laminar, as in a narrow gap, 0 to 1; 0 where it is left out.
        @shape laminar: Number(FromZero), 0.0 to 1.0, start 0.0;
    } as ValveLeakage
}

impl<S: Scalar> Acts<S> for ValveLeakage<S> {
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
        let suction = self.suction * at.leaks_to(at.suction, gap);
        let discharge = self.discharge * at.leaks_to(at.discharge, gap);
        -((suction + discharge) * self.gas_speed) * at.loss_of_flow()
    }
}
