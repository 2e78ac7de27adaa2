//! What turns the crankshaft: a given motion, or a motor that pulls on a free one.

use crate::lift::{alternatives, parameters};
use scalar::Scalar;

alternatives! {
    /// How the crank angle θ comes about.
    pub enum Drive<S> {
        /// θ is a given function of time.
        Given(GivenSpeed),
        /// J θ̈ = T0 + kT (ω_ref − θ̇) − torque of the throws.
        Free(MotorLine),
    }
}

parameters! {
    /// A crank that turns at a given speed, which no load changes:
    ///
    /// ```text
    /// θ = φ + Σ (d_k / k) sin(k φ + ψ_k),   φ = ω t
    /// ```
    pub struct GivenSpeed<S> {
        /// Mean angular speed ω, rad/s.
        pub speed: S,
        /// How the speed fluctuates: the harmonics k = 1, 2, ... in their order; none where it is
        /// constant.
        pub fluctuation: Vec<Fluctuation<S>>,
    }
}

parameters! {
    /// A harmonic of a crank's speed, θ̇ = ω (1 + Σ d_k cos(k φ + ψ_k)).
    pub struct Fluctuation<S> {
        /// Amplitude d_k over the mean speed.
        pub amplitude: S,
        /// Phase ψ_k, rad.
        pub phase: S,
    }
}

impl<S: Scalar> GivenSpeed<S> {
    /// Crank angle, its rate and its second derivative at the time `t`.
    #[inline(always)]
    pub(crate) fn motion(&self, t: S) -> [S; 3] {
        let turned = self.speed * t;
        let mut motion = [turned, self.speed, S::zero()];
        let harmonics = (1..).map(f64::from).zip(&self.fluctuation);
        for (k, harmonic) in harmonics {
            let (sine, cosine) = (turned * k + harmonic.phase).sin_cos();
            motion[0] += harmonic.amplitude * sine / k;
            motion[1] += self.speed * harmonic.amplitude * cosine;
            motion[2] -= self.speed * self.speed * harmonic.amplitude * sine * k;
        }
        motion
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

impl<S: Scalar> Drive<S> {
    /// The speed about which the crank turns, rad/s.
    #[inline(always)]
    pub fn reference_speed(&self) -> S {
        match self {
            Drive::Given(given) => given.speed,
            Drive::Free(motor) => motor.reference_speed,
        }
    }

    /// Whether the crank's speed is the same at all times.
    #[inline(always)]
    pub(crate) fn is_constant(&self) -> bool {
        matches!(self, Drive::Given(given) if given.fluctuation.is_empty())
    }
}
