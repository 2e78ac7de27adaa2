//! Friction of piston rings and packing on the crosshead body. It has a constant part from the rings'
//! tension, and a part that the gas pressure behind the rings adds (the same two as Rezeka and Henein
//! 1984).
//!
//! ```text
//! F = −(F0 + b p) v / √(v² + vs²) − d v
//! ```
//!
//! The oil between rings and liner adds the last part (Stribeck 1902: beyond the speed at which a film forms, friction
//! grows with speed).
//!
//! Signature: a step at both dead centres, odd orders; grows with pressure, not with speed.

use super::acts::{Acts, PistonAt};
use crate::declaration;
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of the rings.
    pub struct RingFriction<S> {
        /// Friction F0 without pressure, N; plausible 0 to 5 % of the piston's gas load.
        pub coulomb_force: S,
        /// Friction b per head-end pressure, N/Pa.
        pub per_pressure: S,
        /// Speed vs over which the sign change is spread, m/s.
        pub slip_speed: S,
        /// Friction d per speed, N s/m.
        pub viscous: S,
    }
}

declaration! {
    /// Friction of the rings: a constant part and one that grows with the gas pressure.
    RingFriction at [Throw], RunningGear:
    "The piston rings and the packing rub: a force against the motion that changes sign at both dead centres."
    law "−(F₀ + b p) v/√(v² + v_s²) − d v" after "Rezeka and Henein 1984" {
        /// Friction force without gas pressure.
        coulomb_force: Force(FromZero), 1.0 to 5000.0, start 100.0, absent 0.0;
        /// Friction force per head-end pressure.
        per_pressure: ForcePerPressure(FromZero), 1e-6 to 5e-3, start 2e-4, absent 0.0;
        /// Piston speed over which the change of sign is spread; 0.05 m/s where it is left out.
        slip_speed: Velocity(AboveZero), 0.001 to 0.5, start 0.05;
        /// Friction per speed, of the oil; 0 N s/m where it is left out.
        @shape viscous: Damping(FromZero), 0.0 to 60.0, start 0.0;
    } as RingFriction
}

impl<S: Scalar> Acts<S> for RingFriction<S> {
    #[inline(always)]
    fn piston_force(&self, at: &PistonAt<S>) -> S {
        let (speed, slip) = (at.speed, self.slip_speed);
        let size = self.coulomb_force + self.per_pressure * at.pressure;
        -(size * speed) / (speed * speed + slip * slip).sqrt() - self.viscous * speed
    }
}
