//! Gas force with ideal valves, single or double acting (MODEL.md, sections 3 and 6).

use crate::lift::parameters;
use crate::mode::{ChamberMode, flagged};
use scalar::Scalar;

parameters! {
    /// Cylinder, piston and gas of one throw.
    pub struct Cylinder<S> {
        /// Piston radius, m.
        pub piston_radius: S,
        /// Suction pressure ps, absolute, Pa.
        pub suction: S,
        /// Discharge pressure pd, absolute, Pa.
        pub discharge: S,
        /// Pressure pb behind a single-acting piston, and on the end of a double-acting one's
        /// rod, absolute, Pa.
        pub back: S,
        /// Polytropic exponent m.
        pub exponent: S,
        /// Clearance S0 between piston and head at top dead centre, m.
        pub head_clearance: S,
        /// The crank-end chamber of a double-acting cylinder.
        pub crank_end: Option<CrankEnd<S>>,
    }
}

parameters! {
    /// The second chamber of a double-acting cylinder.
    pub struct CrankEnd<S> {
        /// Piston-rod radius, m.
        pub rod_radius: S,
        /// Clearance S0c between piston and crank-end cover at bottom dead centre, m.
        pub clearance: S,
    }
}

/// A chamber, whichever end it is at: gas between a piston and a cover.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chamber<S> {
    /// Distance from piston to cover at the chamber's own dead centre, m.
    pub dead: S,
    /// Stroke of the ideal mechanism, m.
    pub stroke: S,
    /// Suction and discharge pressure, Pa.
    pub lines: [S; 2],
    /// Polytropic exponent.
    pub exponent: S,
}

/// Pressure in a chamber, and what the valves' switching depends on. Pa.
#[derive(Clone, Copy, Debug)]
pub struct GasState<S> {
    /// The pressure.
    pub pressure: S,
    /// What it would be with both valves closed.
    closed: S,
    /// Pressures at which the open valves hold the chamber: suction, discharge.
    open: [S; 2],
}

impl<S: Scalar> GasState<S> {
    /// A chamber that is not there.
    pub(crate) fn none() -> Self {
        Self {
            pressure: S::zero(),
            closed: S::zero(),
            open: [S::zero(); 2],
        }
    }

    /// Guards of the suction and the discharge valve's state in `mode`.
    pub(crate) fn guards(&self, mode: &ChamberMode<S>) -> [S; 2] {
        let [low, high] = self.open;
        let shut = S::one();
        let both_shut = S::one() - mode.suction - mode.discharge;
        [
            flagged(
                mode.suction,
                low - self.closed,
                flagged(both_shut, self.closed - low, shut),
            ),
            flagged(
                mode.discharge,
                self.closed - high,
                flagged(both_shut, high - self.closed, shut),
            ),
        ]
    }

    /// The mode that the pressures call for.
    pub(crate) fn mode(&self) -> ChamberMode<S> {
        let flag = |mask| S::select(mask, S::one(), S::zero());
        ChamberMode {
            suction: flag(self.closed.lt(self.open[0])),
            discharge: flag(self.open[1].lt(self.closed)),
        }
    }
}

impl<S: Scalar> Chamber<S> {
    /// The gas with the piston `distance` from the cover; `expanding` is 1 while it moves away,
    /// `open` are the pressures at which open valves hold the chamber.
    #[inline]
    pub fn state(
        &self,
        distance: S,
        expanding: S,
        open: [S; 2],
        mode: &ChamberMode<S>,
    ) -> GasState<S> {
        let [suction, discharge] = self.lines;
        let from = flagged(expanding, discharge, suction);
        let start = flagged(expanding, self.dead, self.stroke + self.dead);
        let closed = from * (start / distance).powf(self.exponent);
        let pressure = flagged(
            mode.discharge,
            open[1],
            flagged(mode.suction, open[0], closed),
        );
        GasState {
            pressure,
            closed,
            open,
        }
    }
}
