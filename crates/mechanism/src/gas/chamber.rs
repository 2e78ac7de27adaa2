//! A chamber of a cylinder: its pressure, and how its valves switch.

use crate::mode::{ChamberMode, flagged};
use scalar::Scalar;

/// A pressure this near to a line's, as a share, differs from it by rounding.
const AT_LINE: f64 = 1e-9;

/// A chamber, whichever end it is at: gas between a piston and a cover.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chamber<S> {
    /// Distance from piston to cover at the chamber's own dead centre, m.
    pub dead: S,
    /// Distance at which the compression starts: where the suction valve closes, m.
    pub filled: S,
    /// Suction and discharge pressure at the dead centres, Pa.
    pub lines: [S; 2],
    /// Polytropic exponents of compression and expansion.
    pub exponents: [S; 2],
}

/// Pressure in a chamber, and what the valves' switching depends on. Pa.
#[derive(Clone, Copy, Debug)]
pub struct GasState<S> {
    /// The pressure.
    pub pressure: S,
    /// What it would be with both valves closed.
    pub(super) closed: S,
    /// Pressures at which the open valves hold the chamber: suction, discharge.
    pub(super) open: [S; 2],
}

impl<S: Scalar> GasState<S> {
    /// A chamber that is not there.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Self {
            pressure: S::zero(),
            closed: S::zero(),
            open: [S::zero(); 2],
        }
    }

    /// What a dead centre traps for the next stroke ([`ChamberMode::trapped`]). The valve that was open
    /// leaves the line's pressure behind, at the ideal piston's place. Gas that never came to the line
    /// stays what it was.
    ///
    /// - `next` is the same gas in the next stroke, with 1 trapped.
    /// - `expanding` is of the next stroke.
    /// - `held` is true where the suction valve of that stroke is held open.
    #[inline(always)]
    pub(crate) fn past_centre(&self, next: &Self, expanding: S, held: bool) -> S {
        let one = S::one();
        let full = match held {
            true => next.open[0],
            false => next.closed,
        };
        let (short, full) = (self.closed / next.closed, self.closed / full);
        flagged(expanding, short.min(one), full.max(one))
    }

    /// What is trapped where the crank turns back within a stroke: the valve that was open closes, and
    /// the pressure stays what it is.
    #[inline(always)]
    pub(crate) fn turned_back(&self, next: &Self) -> S {
        let [suction, discharge] = self.open;
        self.closed.max(suction).min(discharge) / next.closed
    }

    /// Guards of the suction and the discharge valve's state in `mode`.
    #[inline(always)]
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

    /// The mode that the pressures call for, where the closed chamber drifts at `rate`: one that is at
    /// the line and drifts beyond it leaves the valve open.
    #[inline(always)]
    pub(crate) fn mode(&self, expanding: S, rate: S, trapped: S) -> ChamberMode<S> {
        let flag = |mask| S::select(mask, S::one(), S::zero());
        let [suction, discharge] = self.open;
        let falls = flag(rate.lt(S::zero())) * (S::one() - expanding);
        let rises = flag(S::zero().lt(rate)) * expanding;
        ChamberMode {
            suction: flag(self.closed.lt(suction * (falls * AT_LINE + 1.0))),
            discharge: flag((discharge * (S::one() - rises * AT_LINE)).lt(self.closed)),
            trapped,
        }
    }
}

impl<S: Scalar> Chamber<S> {
    /// The gas with the piston `distance` from the cover.
    ///
    /// - `expanding` is 1 while the piston moves away.
    /// - `open` are the pressures at which the open suction and discharge valve hold the chamber, Pa.
    /// - `drift` is the logarithm of how far the closed chamber has left its polytrope.
    #[inline(always)]
    pub fn state(
        &self,
        distance: S,
        expanding: S,
        open: [S; 2],
        drift: Option<S>,
        mode: &ChamberMode<S>,
    ) -> GasState<S> {
        let [suction, discharge] = self.lines;
        let from = flagged(expanding, discharge, suction);
        let start = flagged(expanding, self.dead, self.filled);
        let [compression, expansion] = self.exponents;
        let exponent = flagged(expanding, expansion, compression);
        let mut closed = from * (start / distance).powf(exponent) * mode.trapped;
        if let Some(drift) = drift {
            closed *= drift.exp();
        }
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

    /// Temperature of the gas at `pressure` over that in the suction line. What the cylinder holds
    /// stays, while the valves are closed; what is left in the clearance was compressed before.
    #[inline(always)]
    pub(super) fn warmth(&self, pressure: S, distance: S, expanding: S) -> S {
        let [suction, discharge] = self.lines;
        let [compression, _] = self.exponents;
        let hot = (discharge / suction).powf(S::one() - S::one() / compression);
        let from = flagged(
            expanding,
            discharge * self.dead / hot,
            suction * self.filled,
        );
        pressure * distance / from
    }
}
