//! A force on the crosshead along the cylinder whose law was found in recordings. It is a sum of terms
//! out of a closed library, each with a coefficient in newtons. Method: sparse regression on a library of
//! terms (Brunton, Proctor and Kutz 2016).
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
//! p is the head-end pressure and a the acceleration of an ideal crosshead. eb and es are the offsets of
//! big and small end along the cylinder, cb and cs their clearances. φ is the rod's angle. F is positive
//! toward the head.
//!
//! Every factor is dimensionless, and no factor holds the speed of the crank. The force of a spring, a
//! damper or a rubbing seal depends on its own position, velocity or load. So a law carries over to other
//! speeds and loads. With the velocity over the crank pin's, c3 V would be no damper.

use crate::GRAVITY;
use super::acts::{Acts, PistonAt};
use super::alternatives::Alternatives;
use crate::declaration;
use crate::lift::parameters;
use scalar::Scalar;

/// Standard pressure, Pa.
const BAR: f64 = 1e5;

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

declaration! {
    /// A force on the crosshead along the cylinder, positive toward the head: a sum of the terms
    /// that are stated, each with its coefficient. Other terms there are none.
    EmpiricalForce at [Throw], RunningGear, ForceLaw:
    "A force acts on the crosshead that nothing in the catalogue gives: its law was found in the recordings."
    law "force on the crosshead, a sum of terms out of a library: harmonics, springs, dampers, friction, load, journal offsets" after "Brunton, Proctor and Kutz 2016" {
        /// Coefficient of 1.
        constant: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of cos α, α the crank angle since top dead centre.
        cos_1: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of sin α.
        sin_1: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of cos 2α.
        cos_2: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of sin 2α.
        sin_2: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of cos 3α.
        cos_3: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of sin 3α.
        sin_3: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of cos 4α.
        cos_4: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of sin 4α.
        sin_4: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of X, the displacement from mid-stroke over the length of the crank.
        displacement: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of X³.
        displacement_cubed: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of V, the crosshead's velocity over 1 m/s.
        velocity: Force(Any), -2e4 to 2e4, start 20.0, absent 0.0;
        /// Coefficient of V |V|.
        velocity_squared: Force(Any), -3e3 to 3e3, start 3.0, absent 0.0;
        /// Coefficient of V³.
        velocity_cubed: Force(Any), -500.0 to 500.0, start 0.5, absent 0.0;
        /// Coefficient of the sign s of the velocity.
        velocity_sign: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of P s, P the head-end pressure over 1 bar.
        pressure_sign: Force(Any), -2e4 to 2e4, start 20.0, absent 0.0;
        /// Coefficient of |G tan φ| s, G the gas force over that of 1 bar on the piston, φ the rod's angle.
        side_force_sign: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of an ideal crosshead's acceleration over that of gravity.
        acceleration: Force(Any), -3e3 to 3e3, start 3.0, absent 0.0;
        /// Coefficient of G.
        gas_force: Force(Any), -2e4 to 2e4, start 20.0, absent 0.0;
        /// Coefficient of the big end's offset along the cylinder over its clearance.
        big_end_offset: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Coefficient of the small end's offset along the cylinder over its clearance.
        small_end_offset: Force(Any), -1e5 to 1e5, start 100.0, absent 0.0;
        /// Speed over which the sign s changes; 0.05 m/s where it is left out.
        slip_speed: Velocity(AboveZero), 0.001 to 0.5, start 0.05;
    }
}

/// The law with these values.
pub fn law(values: &[f64], _: Alternatives) -> EmpiricalForce {
    let v = Values::new(values);
    EmpiricalForce {
        constant: v.constant,
        cosines: [v.cos_1, v.cos_2, v.cos_3, v.cos_4],
        sines: [v.sin_1, v.sin_2, v.sin_3, v.sin_4],
        displacement: [v.displacement, v.displacement_cubed],
        velocity: [v.velocity, v.velocity_squared, v.velocity_cubed],
        friction: [v.velocity_sign, v.pressure_sign, v.side_force_sign],
        slip_speed: v.slip_speed,
        acceleration: v.acceleration,
        gas_force: v.gas_force,
        offsets: [v.big_end_offset, v.small_end_offset],
    }
}

impl<S: Scalar> EmpiricalForce<S> {
    /// Σ (ak cos kα + bk sin kα), by the recurrence of the multiple angle.
    #[inline(always)]
    fn harmonics(&self, at: &PistonAt<S>) -> S {
        let (sine, cosine) = at.angle.sin_cos();
        let (mut c, mut s) = (S::one(), S::zero());
        let mut sum = S::zero();
        for (a, b) in self.cosines.iter().zip(&self.sines) {
            (c, s) = (c * cosine - s * sine, s * cosine + c * sine);
            sum = sum + *a * c + *b * s;
        }
        sum
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
