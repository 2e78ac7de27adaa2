//! Where effects act in the equations: one method for each place. By default a method does nothing.

use crate::plane::Vec2;
use scalar::Scalar;
use std::f64::consts::FRAC_PI_2;

/// What a law does at each place where effects can act. A law implements the methods that it needs; those of the chambers are
/// asked of laws of [`Kind::Gas`](crate::declaration::Kind::Gas) alone.
pub(crate) trait Acts<S: Scalar> {
    /// Pressures at which the suction and the discharge valve hold a chamber while open, Pa, from
    /// those without this effect.
    #[inline(always)]
    fn line_pressures(&self, lines: [S; 2], _at: &ChamberAt<S>) -> [S; 2] {
        lines
    }

    /// Crank angle after the dead centre until which the suction valve is held open, rad; none
    /// where it closes by itself.
    #[inline(always)]
    fn suction_held(&self) -> Option<S> {
        None
    }

    /// True where the gas of a closed chamber drifts off its polytrope, so that the chambers need
    /// a state.
    #[inline(always)]
    fn drifts(&self) -> bool {
        false
    }

    /// Rate of the logarithm of the pressure in a closed chamber beyond its polytrope, 1/s.
    #[inline(always)]
    fn drift(&self, _at: &ChamberAt<S>) -> S {
        S::zero()
    }

    /// Force on the crosshead body along x, N.
    #[inline(always)]
    fn piston_force(&self, _at: &PistonAt<S>) -> S {
        S::zero()
    }

    /// Acceleration of the frame, on which everything stands, at crank angle `_angle` (rad) and
    /// speed `_speed` (rad/s), in the machine's coordinates, m/s²; none where the law moves no frame.
    #[inline(always)]
    fn frame_acceleration(&self, _angle: S, _speed: S) -> Option<Vec2<S>> {
        None
    }

    /// Place, m, and rate, m/s, of the frame in the motion that has
    /// [`frame_acceleration`](Self::frame_acceleration) at an even speed; none where the law moves no frame.
    #[inline(always)]
    fn frame_motion(&self, _angle: S, _speed: S) -> Option<[Vec2<S>; 2]> {
        None
    }

    /// The spring that a connecting rod is along its axis; none where it is rigid.
    #[inline(always)]
    fn rod(&self) -> Option<RodSpring<S>> {
        None
    }

    /// By how much bearing and journal are out of round in the directions (cosine, sine) from the x
    /// axes of the two, in a joint of this radial clearance, m; none where both are round.
    #[inline(always)]
    fn shape(&self, _bearing: Vec2<S>, _journal: Vec2<S>, _clearance: S) -> Option<Shape<S>> {
        None
    }

    /// Force of the bearing on the journal along the normal, outward, N.
    #[inline(always)]
    fn film_force(&self, _at: &JointAt<S>) -> S {
        S::zero()
    }
}

/// A chamber at an instant, as effects see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChamberAt<S> {
    /// Crank angle since the throw's top dead centre, rad.
    pub angle: S,
    /// Rate of the distance from piston to cover over the crank pin's speed: above 0 while the
    /// chamber grows.
    pub growth: S,
    /// Distance from piston to cover, m.
    pub distance: S,
    /// The same at the chamber's own dead centre, and where the compression starts, m.
    pub dead: S,
    pub filled: S,
    /// 1 at the head end, −1 at the crank end.
    pub side: S,
    /// Lengths of crank and rod, m.
    pub crank_radius: S,
    pub rod_length: S,
    /// Speed of the crank, rad/s.
    pub speed: S,
    /// Area of the piston on this side, m².
    pub area: S,
    /// Radius of the piston, m.
    pub radius: S,
    /// Mean speed of the piston, m/s.
    pub mean_speed: S,
    /// Pressure, Pa.
    pub pressure: S,
    /// Pressure on the other side of the piston, Pa.
    pub across: S,
    /// Temperature of the gas over that in the suction line.
    pub warmth: S,
    /// Pressures of suction and discharge line, Pa.
    pub suction: S,
    pub discharge: S,
    /// The same as effects make them, at the dead centres where strokes start.
    pub lines: [S; 2],
    /// Polytropic exponents of compression and expansion, and that of the stroke.
    pub exponents: [S; 2],
    pub exponent: S,
    /// 1 while both valves are closed.
    pub closed: S,
}

/// The form of a gap through which gas leaks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap<S> {
    /// Ratio of the pressures below which the gas flows no faster.
    pub critical_ratio: S,
    /// Share of the flow that is laminar.
    pub laminar: S,
}

/// Difference of pressures, over the suction pressure, below which a flow is laminar.
const LAMINAR: f64 = 0.02;

impl<S: Scalar> ChamberAt<S> {
    /// What a gap lets flow, Pa, negative where the gas flows in:
    ///
    /// ```text
    /// (1 − m) √(p² − ((p_other − r p) / (1 − r))²) + m (p² − p_other²) / p_d        p > p_other
    /// ```
    ///
    /// The first part is that of throttles: many in series have r = 0 (Stodola 1927), and one has the ratio at which its flow
    /// chokes, below which it is p (Bendemann 1907). The second is that of a narrow gap (Poiseuille 1846, for a gas), over the discharge pressure.
    #[inline(always)]
    pub fn leaks_to(&self, other: S, gap: Gap<S>) -> S {
        let inward = self.pressure.lt(other);
        let (high, low) = (self.pressure.max(other), self.pressure.min(other));
        let beyond = (low - gap.critical_ratio * high).max(S::zero());
        let low = beyond / (S::one() - gap.critical_ratio);
        let fall = high * high - low * low;
        let squares = S::select(inward, -fall, fall);
        let floor = self.suction * self.suction * (LAMINAR * LAMINAR);
        let throttled = squares / (squares * squares + floor * floor).sqrt().sqrt();
        let narrow = (self.pressure * self.pressure - other * other) / self.discharge;
        throttled + gap.laminar * (narrow - throttled)
    }

    /// n/(p V): the rate at which the logarithm of the pressure falls for a flow ṁ R T, 1/J.
    #[inline(always)]
    pub fn loss_of_flow(&self) -> S {
        self.exponent / (self.pressure * self.area * self.distance)
    }

    /// Crank angle since suction and discharge valve opened, rad, from a quarter of a turn before to three
    /// quarters after. They open at these shares of the lines' pressures, by the polytropes of a piston with
    /// ideal joints.
    #[inline(always)]
    pub fn since_opening(&self, [suction, discharge]: [S; 2]) -> [S; 2] {
        let ratio = self.discharge / self.suction;
        let [compression, expansion] = self.exponents;
        let opened = [
            (
                self.dead * (ratio / suction).powf(S::one() / expansion),
                self.side,
            ),
            (
                self.filled / (ratio * discharge).powf(S::one() / compression),
                -self.side,
            ),
        ];
        let (sine, cosine) = self.angle.sin_cos();
        let turn = S::select(self.speed.lt(S::zero()), -S::one(), S::one());
        // A loop, as `map` of an array may be compiled without the instructions of lanes.
        let mut since = [S::zero(); 2];
        for (since, (distance, side)) in since.iter_mut().zip(opened) {
            let (opened_sine, opened_cosine) = self.crank_at(distance, side * turn);
            let ahead = turn * (sine * opened_cosine - cosine * opened_sine);
            let along = cosine * opened_cosine + sine * opened_sine;
            // Half of the angle since a quarter of a turn after the opening.
            let half = -along / (S::one() + ahead).max(S::constant(f64::MIN_POSITIVE));
            *since = half.atan() * 2.0 + FRAC_PI_2;
        }
        since
    }

    /// Sine, of this sign, and cosine of the crank angle at which the ideal piston is at a distance from the
    /// cover, by the law of cosines in the triangle of crank, rod and line of stroke.
    #[inline(always)]
    fn crank_at(&self, distance: S, sign: S) -> (S, S) {
        let (radius, length) = (self.crank_radius, self.rod_length);
        let crosshead = length + self.side * (radius + self.dead - distance);
        let sum = crosshead * crosshead + radius * radius - length * length;
        let cosine = (sum / (crosshead * radius * 2.0)).clamp(-S::one(), S::one());
        (sign * (S::one() - cosine * cosine).sqrt(), cosine)
    }
}

/// Piston and crosshead at an instant, as effects see them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PistonAt<S> {
    /// Speed along x, m/s.
    pub speed: S,
    /// Pressure at the head end, Pa.
    pub pressure: S,
    /// Pressure of the discharge line, Pa.
    pub discharge: S,
    /// Crank angle since the throw's top dead centre, rad.
    pub angle: S,
    /// Speed of the crank, rad/s.
    pub crank_speed: S,
    /// Mass of crosshead, piston rod and piston, kg.
    pub mass: S,
    /// Displacement along x from the middle of the ideal stroke, m.
    pub displacement: S,
    /// Length of the crank, m.
    pub crank_radius: S,
    /// Length of the rod, m.
    pub rod_length: S,
    /// Tangent of the rod's angle.
    pub rod_slope: S,
    /// Force of the gas along x, N.
    pub gas_force: S,
    /// Area of the piston, m².
    pub area: S,
    /// Offsets of big and small end along x, over their clearances.
    pub offsets: [S; 2],
}

impl<S: Scalar> PistonAt<S> {
    /// Acceleration along x with ideal joints and an even speed, m/s²: the second derivative of
    /// r cos α + √(L² − r² sin² α).
    #[inline(always)]
    pub fn ideal_acceleration(&self) -> S {
        let (r, l) = (self.crank_radius, self.rod_length);
        let (sine, cosine) = self.angle.sin_cos();
        let (height, reach) = (r * sine, r * cosine);
        let along = (l * l - height * height).sqrt();
        let slope = height * reach / along;
        let second = reach + (reach * reach - height * height + slope * slope) / along;
        -(second * self.crank_speed * self.crank_speed)
    }
}

/// A joint with clearance at an instant, as effects see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointAt<S> {
    /// Penetration, m: below 0 while the surfaces are apart.
    pub penetration: S,
    /// Its rate, m/s.
    pub rate: S,
    /// Radial clearance, m.
    pub clearance: S,
    /// Radius of the journal, m.
    pub journal_radius: S,
}

/// How far a joint is out of round in the direction of contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape<S> {
    /// By how much the clearance is wider, m.
    pub wider: S,
    /// Derivative of that by the angle in the bearing, as far as the bearing is out of round, and by
    /// the angle in the journal, m/rad.
    pub change: [S; 2],
}

/// An elastic connecting rod.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RodSpring<S> {
    /// Stiffness between the eyes, N/m.
    pub stiffness: S,
    /// Damping as a share of the critical one of the free rod.
    pub damping_ratio: S,
    /// By what share it is stiffer where the rod is [`HARDENED`] longer.
    pub hardening: S,
}

/// Relative stretch of a rod at which its hardening is stated.
pub(crate) const HARDENED: f64 = 1e-4;
