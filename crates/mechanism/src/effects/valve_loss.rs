//! Pressure lost across open valves: quasi-steady orifice flow, so that the drop grows with the
//! square of the piston speed (Costagliola 1950, in the dimensionless form below).
//!
//! ```text
//! discharge valve open: p = pd (1 − ζd u |u| − λd u + bd e^(−φ/φ0))
//! suction valve open:   p = ps (1 − ζs u |u| − λs u − bs e^(−φ/φ0))
//! ```
//!
//! u is the rate at which the chamber grows, as piston speed over the crank pin's speed R ω: below
//! 0 while gas flows out. λ is what a plate that a spring holds partly closed adds: its opening grows with the
//! flow, so that the drop grows less than with the square. b is what a plate adds that lags: it lets go late, when the gas has
//! passed the line's pressure by this share, and throttles until it has risen. φ is the crank angle since then, from where the polytrope of an
//! ideal piston has reached that pressure. Signature: the plateaus of the indicator diagram bulge at mid-stroke;
//! orders 2 to 6; dissipates work.

use super::acts::{Acts, ChamberAt};
use crate::declaration;
use crate::lift::parameters;
use scalar::{Scalar, inlined};

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
        /// Overshoot bs at the opening of the suction valve, over the line's pressure; below 1.
        pub suction_overshoot: S,
        /// Overshoot bd at the opening of the discharge valve, over the line's pressure.
        pub discharge_overshoot: S,
        /// Crank angle φ0 over which the overshoots fade, rad.
        pub overshoot_angle: S,
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
        /// Overshoot where the suction valve opens, of the line's pressure, as of a plate that lags; 0 % where it is left out.
        @shape suction_overshoot: Ratio(ProperPart), 0.0 to 0.3, start 0.0, other 0.1;
        /// Overshoot where the discharge valve opens, of the line's pressure; 0 % where it is left out.
        @shape discharge_overshoot: Ratio(FromZero), 0.0 to 0.3, start 0.0, other 0.1;
        /// Crank angle over which the overshoots fade; 0.2 rad where it is left out.
        @shape overshoot_angle: Angle(AboveZero), 0.03 to 1.0, start 0.2, other 0.4;
    } as ValveLoss
}

impl<S: Scalar> Acts<S> for ValveLoss<S> {
    #[inline(always)]
    fn line_pressures(&self, [suction, discharge]: [S; 2], at: &ChamberAt<S>) -> [S; 2] {
        let flow = at.growth * at.growth.abs();
        let lost = [
            self.suction * flow + self.suction_linear * at.growth,
            self.discharge * flow + self.discharge_linear * at.growth,
        ];
        let through = [S::one() - lost[0], S::one() - lost[1]];
        // When a plate lets go costs more than all else of the law.
        if self.suction_overshoot.is_zero() && self.discharge_overshoot.is_zero() {
            return [suction * through[0], discharge * through[1]];
        }
        let since = at.since_opening([S::one() - self.suction_overshoot, S::one() + self.discharge_overshoot]);
        let faded = inlined(
            #[inline(always)]
            |angle: S| (-(angle.max(S::zero()) / self.overshoot_angle)).exp(),
        );
        [
            suction * (through[0] - self.suction_overshoot * faded(since[0])),
            discharge * (through[1] + self.discharge_overshoot * faded(since[1])),
        ]
    }
}
