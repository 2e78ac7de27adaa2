//! What turns the crankshaft: a given speed, or a motor that pulls on a free one.

use crate::lift::{alternatives, parameters};

alternatives! {
    /// How the crank angle θ comes about.
    pub enum Drive<S> {
        /// θ = ω t exactly.
        Given(GivenSpeed),
        /// J θ̈ = T0 + kT (ω_ref − θ̇) − torque of the throws.
        Free(MotorLine),
    }
}

parameters! {
    /// A crank that turns at constant speed, whatever it takes.
    pub struct GivenSpeed<S> {
        /// Angular speed ω, rad/s.
        pub speed: S,
    }
}

parameters! {
    /// A free crank on the straight part of a motor's torque–speed line (MODEL.md, section 6).
    pub struct MotorLine<S> {
        /// Speed ω_ref at which the motor gives the mean torque, rad/s; also the initial speed.
        pub reference_speed: S,
        /// Torque T0 at the reference speed, N m.
        pub mean_torque: S,
        /// Slope kT of the torque–speed line, N m s.
        pub slope: S,
    }
}

impl<S: scalar::Scalar> Drive<S> {
    /// The speed about which the crank turns, rad/s.
    pub fn reference_speed(&self) -> S {
        match self {
            Drive::Given(given) => given.speed,
            Drive::Free(motor) => motor.reference_speed,
        }
    }

    /// The sense of rotation: 1 counter-clockwise, −1 clockwise (a negative speed).
    pub(crate) fn sense(&self) -> S {
        let clockwise = self.reference_speed().lt(S::zero());
        S::select(clockwise, -S::one(), S::one())
    }
}
