//! Gas force with ideal valves, single or double acting (MODEL.md, sections 3 and 6).

use crate::effects::{Acting, Acts, ChamberAt, End, PistonAt};
use crate::joints::revolute::Revolute;
use crate::lift::parameters;
use crate::machine::Throw;
use crate::mode::{ChamberMode, ThrowMode, flagged};
use crate::plane::Vec2;
use crate::throw::Motion;
use scalar::Scalar;
use std::f64::consts::PI;

/// Rate, per radian of the crank, at which a valve that has opened again brings a chamber back to the
/// line: within a third of a degree.
const REFILL: f64 = 200.0;
/// A pressure this near to a line's, as a share, differs from it by rounding.
const AT_LINE: f64 = 1e-9;

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
    closed: S,
    /// Pressures at which the open valves hold the chamber: suction, discharge.
    open: [S; 2],
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

    /// What a dead centre traps for the next stroke ([`ChamberMode::trapped`]), where `next` is the same
    /// gas as that stroke has it with 1: the valve that was open leaves the line's pressure behind,
    /// at the ideal piston's place. Gas that never came to the line stays what it was. `expanding` is of
    /// the next stroke, `held` whether its suction valve is held open.
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
    /// The gas with the piston `distance` from the cover; `expanding` is 1 while it moves away,
    /// `open` are the pressures at which open valves hold the chamber, `drift` is the logarithm of
    /// how far the closed chamber has left its polytrope.
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
}

impl<S: Scalar> Chamber<S> {
    /// Temperature of the gas at `pressure` over that in the suction line. What the cylinder holds
    /// stays, while the valves are closed; what is left in the clearance was compressed before.
    #[inline(always)]
    fn warmth(&self, pressure: S, distance: S, expanding: S) -> S {
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
    /// Rates of the drifts of head end and crank end off their polytropes, 1/s.
    pub(crate) drift: [S; 2],
}

impl<S: Scalar> Gas<S> {
    /// Nothing yet.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Self {
            head_end: GasState::none(),
            crank_end: GasState::none(),
            force: S::zero(),
            effects: S::zero(),
            drift: [S::zero(); 2],
        }
    }

    /// Sets the valves of head end and crank end as the pressures call for.
    #[inline(always)]
    pub(crate) fn set_valves(&self, mode: &mut ThrowMode<S>) {
        let ([head, crank], outward) = (self.drift, mode.outward);
        let trapped = [mode.head_end.trapped, mode.crank_end.trapped];
        mode.head_end = self.head_end.mode(outward, head, trapped[0]);
        mode.crank_end = (self.crank_end).mode(S::one() - outward, crank, trapped[1]);
    }
}

impl Gas<f64> {
    /// What the gas of the throw and the back pressure hold for the piston, J, to a constant; none with two
    /// exponents. The work that a chamber does until it is at the suction pressure, all valves closed, and
    /// what a constant pressure holds:
    ///
    /// ```text
    /// A (∫ (p − ps) dx − ps x),   p xᵐ constant
    /// ```
    ///
    /// It falls with whatever passes a valve and a reversal, and changes by the work alone elsewhere.
    pub(crate) fn held(&self, throw: &Throw<f64>, motion: &Motion<f64>) -> Option<f64> {
        let cylinder = &throw.cylinder;
        let (exponent, suction) = (cylinder.exponent, cylinder.suction);
        if exponent != cylinder.expansion_exponent {
            return None;
        }
        let of = |pressure: f64, x: f64| {
            let ratio = (pressure / suction).max(1.0);
            let full = x * ratio.powf(1.0 / exponent);
            // ∫ p dx from x to where it is at the suction pressure; (yᵃ − 1)/a tends to ln y.
            let power = 1.0 - 1.0 / exponent;
            let grown = match exponent == 1.0 {
                true => ratio.ln(),
                false => (1.0 - ratio.powf(-power)) / (exponent - 1.0),
            };
            pressure * x * grown - suction * full
        };
        let face = area(cylinder.piston_radius);
        let reach = throw.crank_radius + throw.rod.length;
        let to_head = cylinder.head_clearance + reach - motion.crosshead;
        let head = face * of(self.head_end.pressure, to_head);
        Some(match &cylinder.crank_end {
            None => head - face * cylinder.back * motion.crosshead,
            Some(end) => {
                let rod = area(end.rod_radius);
                let to_cover =
                    end.clearance + motion.crosshead - (throw.rod.length - throw.crank_radius);
                let crank = (face - rod) * of(self.crank_end.pressure, to_cover);
                head + crank - rod * cylinder.back * motion.crosshead
            }
        })
    }
}

/// One throw's cylinder at an instant: what both of its chambers share.
pub(crate) struct CylinderAt<'a, S> {
    /// The throw.
    pub throw: &'a Throw<S>,
    /// The effects on it.
    pub effects: Acting<'a, S>,
    /// Its motion.
    pub motion: &'a Motion<S>,
    /// Speed of the crank, rad/s.
    pub speed: S,
    /// Offsets of big and small end, m.
    pub offsets: [Vec2<S>; 2],
    /// Its mode.
    pub mode: &'a ThrowMode<S>,
    /// Logarithms of how far head end and crank end have left their polytropes.
    pub drift: Option<[S; 2]>,
}

impl<S: Scalar> CylinderAt<'_, S> {
    /// The gas of the throw (MODEL.md, sections 3 and 6), and the effects on the piston.
    #[inline(always)]
    pub fn gas<const PLAIN: bool>(&self) -> Gas<S> {
        let (throw, motion) = (self.throw, self.motion);
        let cylinder = &throw.cylinder;
        let face = area(cylinder.piston_radius);
        let reach = throw.crank_radius + throw.rod.length;
        let to_head = cylinder.head_clearance + reach - motion.crosshead;
        let (head_end, head) = self.chamber::<PLAIN>(End::Head, cylinder.head_clearance, to_head);
        let mut crank = None;
        let (crank_end, force) = match &cylinder.crank_end {
            None => (GasState::none(), (cylinder.back - head_end.pressure) * face),
            Some(end) => {
                let to_cover =
                    end.clearance + motion.crosshead - (throw.rod.length - throw.crank_radius);
                let (gas, seen) = self.chamber::<PLAIN>(End::Crank, end.clearance, to_cover);
                crank = seen;
                let rod = area(end.rod_radius);
                let force = gas
                    .pressure
                    .mul_add(face - rod, cylinder.back * rod - head_end.pressure * face);
                (gas, force)
            }
        };
        let piston = || PistonAt {
            speed: motion.crosshead_rate,
            pressure: head_end.pressure,
            angle: motion.angle,
            crank_speed: self.speed,
            mass: throw.crosshead.mass,
            displacement: motion.crosshead - throw.rod.length,
            crank_radius: throw.crank_radius,
            rod_length: throw.rod.length,
            rod_slope: motion.rod_sin_cos.0 / motion.rod_sin_cos.1,
            gas_force: force,
            area: face,
            offsets: [
                eccentricity(&throw.big_end, self.offsets[0]),
                eccentricity(&throw.small_end, self.offsets[1]),
            ],
        };
        let effects = match self.effects.any() {
            false => S::zero(),
            true => {
                let piston = piston();
                let forces = self.effects.all().map(|e| e.piston_force(&piston));
                forces.fold(S::zero(), |sum, force| sum + force)
            }
        };
        Gas {
            head_end,
            crank_end,
            force,
            effects,
            drift: self.drifts([(&head_end, head), (&crank_end, crank)]),
        }
    }

    /// The chamber at one end with its piston `distance` from the cover, `dead` at the dead centre;
    /// and as effects see it, where there are any.
    #[inline(always)]
    fn chamber<const PLAIN: bool>(
        &self,
        end: End,
        dead: S,
        distance: S,
    ) -> (GasState<S>, Option<ChamberAt<S>>) {
        match PLAIN {
            true => self.chamber_here(end, dead, distance),
            false => self.chamber_apart(end, dead, distance),
        }
    }

    #[inline(never)]
    fn chamber_apart(&self, end: End, dead: S, distance: S) -> (GasState<S>, Option<ChamberAt<S>>) {
        S::vectorised(
            #[inline(always)]
            || self.chamber_here(end, dead, distance),
        )
    }

    #[inline(always)]
    fn chamber_here(&self, end: End, dead: S, distance: S) -> (GasState<S>, Option<ChamberAt<S>>) {
        let (throw, cylinder) = (self.throw, &self.throw.cylinder);
        let (expanding, mode) = match end {
            End::Head => (self.mode.outward, &self.mode.head_end),
            End::Crank => (S::one() - self.mode.outward, &self.mode.crank_end),
        };
        let lines = [cylinder.suction, cylinder.discharge];
        let mut chamber = Chamber {
            dead,
            filled: throw.crank_radius * 2.0 + dead,
            lines,
            exponents: [cylinder.exponent, cylinder.expansion_exponent],
        };
        if !self.effects.any() {
            return (chamber.state(distance, expanding, lines, None, mode), None);
        }
        chamber.filled -= self.retreat(end);
        let mut seen = self.seen(end, &chamber, distance, expanding, mode);
        chamber.lines = self.lines_at_centres(end, seen);
        let drift = self.drift.map(|drift| drift[end as usize]);
        let open = self.lines(end, &seen);
        let state = chamber.state(distance, expanding, open, drift, mode);
        seen.pressure = state.pressure;
        if drift.is_some() {
            seen.warmth = chamber.warmth(state.pressure, distance, expanding);
        }
        (state, Some(seen))
    }

    /// The chamber as effects see it, before its pressure is known.
    #[inline(always)]
    fn seen(
        &self,
        end: End,
        chamber: &Chamber<S>,
        distance: S,
        expanding: S,
        mode: &ChamberMode<S>,
    ) -> ChamberAt<S> {
        let (throw, motion, cylinder) = (self.throw, self.motion, &self.throw.cylinder);
        let pin = throw.crank_radius * self.speed.abs();
        let outward = motion.crosshead_rate / pin;
        let (growth, rod) = match (end, &cylinder.crank_end) {
            (End::Head, _) => (-outward, S::zero()),
            (End::Crank, None) => (outward, S::zero()),
            (End::Crank, Some(crank_end)) => (outward, area(crank_end.rod_radius)),
        };
        let side = match end {
            End::Head => S::one(),
            End::Crank => -S::one(),
        };
        ChamberAt {
            angle: motion.angle,
            growth,
            distance,
            dead: chamber.dead,
            filled: chamber.filled,
            side,
            crank_radius: throw.crank_radius,
            rod_length: throw.rod.length,
            speed: self.speed,
            area: area(cylinder.piston_radius) - rod,
            radius: cylinder.piston_radius,
            mean_speed: pin * (2.0 / PI),
            pressure: S::zero(),
            across: cylinder.back,
            warmth: S::one(),
            suction: cylinder.suction,
            discharge: cylinder.discharge,
            exponents: chamber.exponents,
            exponent: flagged(expanding, cylinder.expansion_exponent, cylinder.exponent),
            closed: S::one() - mode.suction - mode.discharge,
        }
    }

    /// Suction and discharge pressure where the valves leave off and the strokes start, at the dead
    /// centres.
    #[inline(always)]
    fn lines_at_centres(&self, end: End, seen: ChamberAt<S>) -> [S; 2] {
        let angles = match end {
            End::Head => [PI, 0.0],
            End::Crank => [0.0, PI],
        };
        let [filled, emptied] = angles.map(|angle| {
            let at_centre = ChamberAt {
                angle: S::constant(angle),
                growth: S::zero(),
                ..seen
            };
            self.lines(end, &at_centre)
        });
        [filled[0], emptied[1]]
    }

    /// Pressures at which the open valves hold the chamber: suction, discharge.
    #[inline(always)]
    fn lines(&self, end: End, seen: &ChamberAt<S>) -> [S; 2] {
        let mut lines = [self.throw.cylinder.suction, self.throw.cylinder.discharge];
        for effect in self.effects.at_end(end) {
            lines = effect.line_pressures(lines, seen);
        }
        lines
    }

    /// How far the ideal piston has come back from the dead centre when the suction valve closes, m.
    #[inline(always)]
    fn retreat(&self, end: End) -> S {
        let mut held = self.effects.at_end(end).filter_map(|e| e.suction_held());
        let Some(angle) = held.next() else {
            return S::zero();
        };
        let (radius, length) = (self.throw.crank_radius, self.throw.rod.length);
        let (sine, cosine) = angle.sin_cos();
        let slope = sine * radius / length;
        let rod = length * (S::one() - (S::one() - slope * slope).sqrt());
        let crank = radius * (S::one() - cosine);
        match end {
            End::Head => crank - rod,
            End::Crank => crank + rod,
        }
    }

    /// Rates of the drifts of both chambers, 1/s; while a valve is open there is none, unless it is one that
    /// the drift has opened again.
    #[inline(always)]
    fn drifts(&self, chambers: [(&GasState<S>, Option<ChamberAt<S>>); 2]) -> [S; 2] {
        // The first is known to the compiler where a machine is plain.
        if !self.effects.any() || self.drift.is_none() {
            return [S::zero(); 2];
        }
        [End::Head, End::Crank].map(|end| {
            let (state, Some(mut chamber)) = chambers[end as usize] else {
                return S::zero();
            };
            let other = chambers[1 - end as usize].1.map(|other| other.pressure);
            chamber.across = other.unwrap_or(chamber.across);
            let effects = self.effects.at_end(end);
            let rate = effects.fold(S::zero(), |sum, effect| sum + effect.drift(&chamber));
            chamber.closed * rate + self.reopened(end, state, rate)
        })
    }

    /// Rate of the drift, 1/s, where a valve stands open in the stroke that closed it; 0 elsewhere. Near a
    /// dead centre gas that leaks is faster than the piston: the pressure falls back to the line's, and stays
    /// there until the piston is the faster one, as what leaks flows in again. Where a clearance alone has the
    /// piston beyond its dead centre nothing drifts.
    #[inline(always)]
    fn reopened(&self, end: End, state: &GasState<S>, rate: S) -> S {
        let (expanding, mode) = match end {
            End::Head => (self.mode.outward, &self.mode.head_end),
            End::Crank => (S::one() - self.mode.outward, &self.mode.crank_end),
        };
        // One that is held has not closed yet.
        let held = self.effects.at_end(end).any(|e| e.suction_held().is_some());
        let suction = match held {
            true => S::zero(),
            false => mode.suction * (S::one() - expanding),
        };
        let discharge = mode.discharge * expanding;
        let (zero, side) = (S::zero(), suction - discharge);
        let line = flagged(suction, state.open[0], state.open[1]);
        let drift = self.drift.map_or(zero, |drift| drift[end as usize]);
        let to_line = side * (line / state.closed).ln();
        let lost = to_line.min(-side * drift).max(zero);
        let leaks = (side * rate).min(zero);
        let rate = side * (leaks + self.speed.abs() * REFILL * lost);
        flagged(suction + discharge, rate, zero)
    }
}

/// Offset of a joint along x over its clearance; 0 in an ideal one.
#[inline(always)]
fn eccentricity<S: Scalar>(joint: &Revolute<S>, offset: Vec2<S>) -> S {
    match joint.clear() {
        None => S::zero(),
        Some(clear) => offset.x / clear.clearance,
    }
}

#[inline(always)]
fn area<S: Scalar>(radius: S) -> S {
    radius * radius * PI
}
