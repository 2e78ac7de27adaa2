//! The pressures in a cylinder and their force, from the motion of its piston.

use super::chamber::{Chamber, GasState};
use super::cylinder::area;
use super::throw_gas::Gas;
use crate::declaration::Kind;
use crate::effects::{Acting, Acts, ChamberAt, End, PistonAt};
use crate::joints::revolute::Revolute;
use crate::machine::Throw;
use crate::mode::{ChamberMode, ThrowMode, flagged};
use crate::plane::Vec2;
use crate::throw::Motion;
use scalar::Scalar;
use std::f64::consts::PI;

/// Rate, per radian of the crank, at which a valve that has opened again brings a chamber back to the
/// line: within a third of a degree.
const REFILL: f64 = 200.0;
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
    /// Suction and discharge pressure of head end and crank end at the dead centres, where they are known.
    pub centres: Option<[[S; 2]; 2]>,
}

/// Which chamber, and the distances from its piston to its cover, m: at the dead centre, and now.
#[derive(Clone, Copy)]
struct ChamberPlace<S> {
    end: End,
    dead: S,
    distance: S,
}

/// What is found of a chamber: its gas; and it as effects see it, where any act on the gas.
type Found<'f, S> = (&'f mut GasState<S>, &'f mut Option<ChamberAt<S>>);

impl<S: Scalar> CylinderAt<'_, S> {
    /// Finds the gas of the throw (MODEL.md, sections 3 and 6), and the effects on the piston, in place.
    #[inline(always)]
    pub fn find<const PLAIN: bool>(&self, gas: &mut Gas<S>) {
        let (throw, motion) = (self.throw, self.motion);
        let cylinder = &throw.cylinder;
        let face = area(cylinder.piston_radius);
        let reach = throw.crank_radius + throw.rod.length;
        let to_head = cylinder.head_clearance + reach - motion.crosshead;
        let mut seen = [None, None];
        let [head, crank] = &mut seen;
        let place = ChamberPlace {
            end: End::Head,
            dead: cylinder.head_clearance,
            distance: to_head,
        };
        self.chamber::<PLAIN>(place, (&mut gas.head_end, head));
        gas.force = match &cylinder.crank_end {
            None => (cylinder.back - gas.head_end.pressure) * face,
            Some(end) => {
                let to_cover =
                    end.clearance + motion.crosshead - (throw.rod.length - throw.crank_radius);
                let place = ChamberPlace {
                    end: End::Crank,
                    dead: end.clearance,
                    distance: to_cover,
                };
                self.chamber::<PLAIN>(place, (&mut gas.crank_end, crank));
                let rod = area(end.rod_radius);
                let back = cylinder.back * rod - gas.head_end.pressure * face;
                gas.crank_end.pressure.mul_add(face - rod, back)
            }
        };
        gas.effects = match self.effects.any() {
            false => S::zero(),
            true => {
                let piston = PistonAt {
                    speed: motion.crosshead_rate,
                    pressure: gas.head_end.pressure,
                    discharge: throw.cylinder.discharge,
                    angle: motion.angle,
                    crank_speed: self.speed,
                    mass: throw.crosshead.mass,
                    displacement: motion.crosshead - throw.rod.length,
                    crank_radius: throw.crank_radius,
                    rod_length: throw.rod.length,
                    rod_slope: motion.rod_sin_cos.0 / motion.rod_sin_cos.1,
                    gas_force: gas.force,
                    area: face,
                    offsets: [
                        eccentricity(&throw.big_end, self.offsets[0]),
                        eccentricity(&throw.small_end, self.offsets[1]),
                    ],
                };
                let mut sum = S::zero();
                for effect in self.effects.all() {
                    sum += effect.piston_force(&piston);
                }
                sum
            }
        };
        gas.drift = self.drifts([&gas.head_end, &gas.crank_end], &mut seen);
        let [head, crank] = &seen;
        gas.centres = match (head, crank) {
            (None, _) => None,
            (Some(head), None) => Some([head.lines, head.lines]),
            (Some(head), Some(crank)) => Some([head.lines, crank.lines]),
        };
    }

    #[inline(always)]
    fn chamber<const PLAIN: bool>(&self, place: ChamberPlace<S>, found: Found<S>) {
        match PLAIN {
            true => self.chamber_here(place, found),
            false => self.chamber_apart(place, found),
        }
    }

    #[inline(never)]
    fn chamber_apart(&self, place: ChamberPlace<S>, found: Found<S>) {
        S::vectorised(
            #[inline(always)]
            || self.chamber_here(place, found),
        )
    }

    #[inline(always)]
    fn chamber_here(&self, place: ChamberPlace<S>, (state, as_seen): Found<S>) {
        let ChamberPlace {
            end,
            dead,
            distance,
        } = place;
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
        if !self.effects.any_on(Kind::Gas) {
            *state = chamber.state(distance, expanding, lines, None, mode);
            return;
        }
        chamber.filled -= self.retreat(end);
        let seen = as_seen.insert(self.seen(end, &chamber, distance, expanding, mode));
        chamber.lines = match self.centres {
            Some(known) => known[end as usize],
            None => self.lines_at_centres(end, seen),
        };
        seen.lines = chamber.lines;
        let drift = self.drift.map(|drift| drift[end as usize]);
        let open = self.lines(end, seen);
        *state = chamber.state(distance, expanding, open, drift, mode);
        seen.pressure = state.pressure;
        if drift.is_some() {
            seen.warmth = chamber.warmth(state.pressure, distance, expanding);
        }
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
            lines: chamber.lines,
            exponents: chamber.exponents,
            exponent: flagged(expanding, cylinder.expansion_exponent, cylinder.exponent),
            closed: S::one() - mode.suction - mode.discharge,
        }
    }

    /// Suction and discharge pressure where the valves leave off and the strokes start, at the dead
    /// centres.
    #[inline(always)]
    fn lines_at_centres(&self, end: End, seen: &ChamberAt<S>) -> [S; 2] {
        let angles = match end {
            End::Head => [PI, 0.0],
            End::Crank => [0.0, PI],
        };
        let mut lines = [S::zero(); 2];
        for (i, angle) in angles.into_iter().enumerate() {
            let at_centre = ChamberAt {
                angle: S::constant(angle),
                growth: S::zero(),
                ..*seen
            };
            lines[i] = self.lines(end, &at_centre)[i];
        }
        lines
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
    fn drifts(&self, states: [&GasState<S>; 2], seen: &mut [Option<ChamberAt<S>>; 2]) -> [S; 2] {
        // The first is known to the compiler where a machine is plain.
        if !self.effects.any_on(Kind::Gas) || self.drift.is_none() {
            return [S::zero(); 2];
        }
        let mut drifts = [S::zero(); 2];
        for end in [End::Head, End::Crank] {
            let across = seen[1 - end as usize].as_ref().map(|other| other.pressure);
            let Some(chamber) = &mut seen[end as usize] else {
                continue;
            };
            if let Some(across) = across {
                chamber.across = across;
            }
            let mut rate = S::zero();
            for effect in self.effects.at_end(end) {
                rate += effect.drift(chamber);
            }
            let reopened = self.reopened(end, states[end as usize], rate);
            drifts[end as usize] = chamber.closed * rate + reopened;
        }
        drifts
    }

    /// Rate of the drift, 1/s, where a valve stands open in the stroke that closed it; 0 elsewhere. Near a
    /// dead centre gas that leaks is faster than the piston. The pressure falls back to the line's, as what
    /// leaks flows in again, and stays there until the piston is the faster one. Where a clearance alone has the
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
