//! A force on the crosshead along the cylinder whose law was found in recordings: a sum of terms out
//! of a closed library, each with a coefficient in newtons (sparse regression on a library of terms:
//! Brunton, Proctor and Kutz 2016).
//!
//! ```text
//! F = c0 + Σ (ak cos kα + bk sin kα)                              k = 1..4, crank angle α
//!   + c1 X + c2 X³                                                X = (x − L)/r, from mid-stroke
//!   + c3 V + c4 V|V| + c5 V³                                      V = v/(1 m/s)
//!   + c6 s + c7 P s + c8 |G tan φ| s                              s = v/√(v² + vs²)
//!   + c9 a/g + c10 G                                              P = p/(1 bar)
//!   + c11 eb/cb + c12 es/cs                                       G = gas force/(piston area × 1 bar)
//! ```
//!
//! Every factor is free of units, and none holds the speed of the crank: what a spring, a damper or a
//! rubbing seal does depends on its own position, velocity or load, so that a law carries over to
//! other speeds and loads. (The velocity over the crank pin's would be the same at all speeds, and
//! c3 V no damper.) p is the head-end pressure, a the acceleration of an ideal crosshead, eb and es
//! the offsets of big and small end along the cylinder over their clearances, φ the rod's angle. F is
//! positive toward the head.

use super::{Acts, PistonAt};
use crate::lift::parameters;
use scalar::Scalar;

/// Standard pressure, Pa, and standard gravity, m/s².
const BAR: f64 = 1e5;
const GRAVITY: f64 = 9.80665;

parameters! {
    /// Coefficients of the terms, N.
    pub struct EmpiricalForce<S> {
        /// c0.
        pub constant: S,
        /// a1 to a4.
        pub cosines: [S; 4],
        /// b1 to b4.
        pub sines: [S; 4],
        /// c1 and c2: of the displacement and its cube.
        pub displacement: [S; 2],
        /// c3 to c5: of the velocity, of its square with its sign, and of its cube.
        pub velocity: [S; 3],
        /// c6 to c8: of the sign of the velocity alone, times the pressure, times the side force.
        pub friction: [S; 3],
        /// Speed vs over which the sign of the velocity changes, m/s.
        pub slip_speed: S,
        /// c9.
        pub acceleration: S,
        /// c10.
        pub gas_force: S,
        /// c11 and c12: of the offsets of big and small end.
        pub offsets: [S; 2],
    }
}

impl<S: Scalar> EmpiricalForce<S> {
    /// Σ (ak cos kα + bk sin kα), by the recurrence of the multiple angle.
    #[inline(always)]
    fn harmonics(&self, at: &PistonAt<S>) -> S {
        let (sine, cosine) = at.angle.sin_cos();
        let (mut c, mut s) = (S::one(), S::zero());
        let orders = self.cosines.iter().zip(&self.sines);
        orders.fold(S::zero(), |sum, (a, b)| {
            (c, s) = (c * cosine - s * sine, s * cosine + c * sine);
            sum + *a * c + *b * s
        })
    }
}

impl<S: Scalar> Acts<S> for EmpiricalForce<S> {
    #[inline(always)]
    fn piston_force(&self, at: &PistonAt<S>) -> S {
        let x = at.displacement / at.crank_radius;
        let v = at.speed;
        let sign = v / (v * v + self.slip_speed * self.slip_speed).sqrt();
        let gas = at.gas_force / (at.area * BAR);
        let [spring, hardening] = self.displacement;
        let [viscous, drag, cubic] = self.velocity;
        let [dry, pressed, guided] = self.friction;
        let [big, small] = self.offsets;
        self.constant
            + self.harmonics(at)
            + x * (spring + hardening * x * x)
            + v * (viscous + drag * v.abs() + cubic * v * v)
            + sign * (dry + pressed * (at.pressure / BAR) + guided * (gas * at.rod_slope).abs())
            + self.acceleration * at.ideal_acceleration() / GRAVITY
            + self.gas_force * gas
            + big * at.offsets[0]
            + small * at.offsets[1]
    }
}
