//! Gas force with ideal valves, single or double acting (MODEL.md, sections 3 and 6).

use crate::effects::Effect;
use crate::lift::parameters;
use crate::machine::Throw;
use crate::mode::{ChamberMode, ThrowMode, flagged};
use crate::throw::Motion;
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
        /// Polytropic exponent m of the compression.
        pub exponent: S,
        /// Polytropic exponent of the expansion of what stays in the clearance. MODEL.md has one
        /// exponent for both; in a real cylinder heat and leakage make them differ.
        pub expansion_exponent: S,
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
    /// Polytropic exponents of compression and expansion.
    pub exponents: [S; 2],
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
        let [compression, expansion] = self.exponents;
        let exponent = flagged(expanding, expansion, compression);
        let closed = from * (start / distance).powf(exponent);
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

/// The gas of one throw at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Gas<S> {
    /// Head end.
    pub head_end: GasState<S>,
    /// Crank end; pressure 0 in a single-acting cylinder.
    pub crank_end: GasState<S>,
    /// Force of the gas on the crosshead body along x, N.
    pub force: S,
    /// Force of the effects on the crosshead body along x, N.
    pub effects: S,
}

/// The gas of a throw (MODEL.md, sections 3 and 6), and the effects on the piston.
pub(crate) fn gas<S: Scalar>(
    throw: &Throw<S>,
    effects: &[Effect<S>],
    motion: &Motion<S>,
    speed: S,
    mode: &ThrowMode<S>,
) -> Gas<S> {
    let cylinder = &throw.cylinder;
    let lines = [cylinder.suction, cylinder.discharge];
    let piston = motion.crosshead_rate / (throw.crank_radius * speed);
    let open = effects
        .iter()
        .fold(lines, |open, effect| effect.line_pressures(open, piston));
    let chamber = |dead: S| Chamber {
        dead,
        stroke: throw.crank_radius * 2.0,
        lines,
        exponents: [cylinder.exponent, cylinder.expansion_exponent],
    };
    let area = |radius: S| radius * radius * std::f64::consts::PI;
    let face = area(cylinder.piston_radius);

    let reach = throw.crank_radius + throw.rod.length;
    let to_head = cylinder.head_clearance + reach - motion.crosshead;
    let head_end =
        chamber(cylinder.head_clearance).state(to_head, mode.outward, open, &mode.head_end);
    let (crank_end, force) = match &cylinder.crank_end {
        None => (GasState::none(), (cylinder.back - head_end.pressure) * face),
        Some(end) => {
            let to_cover =
                end.clearance + motion.crosshead - (throw.rod.length - throw.crank_radius);
            let inward = S::one() - mode.outward;
            let gas = chamber(end.clearance).state(to_cover, inward, open, &mode.crank_end);
            let rod = area(end.rod_radius);
            let force =
                gas.pressure * (face - rod) + cylinder.back * rod - head_end.pressure * face;
            (gas, force)
        }
    };
    let effects = effects.iter().fold(S::zero(), |sum, effect| {
        sum + effect.piston_force(motion.crosshead_rate, head_end.pressure)
    });
    Gas {
        head_end,
        crank_end,
        force,
        effects,
    }
}
