//! A valve whose plate swings on its spring once it has opened: it lets go late, and until it has come to
//! rest the pressure in the cylinder swings about the line's (Costagliola 1950, whose plate of mass m
//! on a spring k has the natural frequency ω = √(k/m); here as a damped oscillation of its own,
//! which the flow does not change).
//!
//! ```text
//! suction valve open: p = ps (1 − b s(t))      discharge valve open: p = pd (1 + b s(t))
//! s(t) = e^(−ζ ω t) sin(√(1 − ζ²) ω t)         t: time since the closed gas passed the line's pressure
//! ```
//!
//! While s rises faster than the closed gas, the gas keeps to its polytrope beyond the line's pressure: the valve
//! opens late. The time runs from the angle at which the polytrope of an ideal piston meets the line's
//! pressure. Signature: an overshoot at each opening and a ripple on the plateau behind it, of the same
//! frequency in Hz at every speed, from an angle that moves with the ratio of the pressures.

use super::{Acts, ChamberAt};
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of the valves' plates, the same in every chamber.
    pub struct ValveFlutter<S> {
        /// Natural frequency ω of the plates, rad/s.
        pub natural_frequency: S,
        /// Damping ratio ζ, below 1.
        pub damping_ratio: S,
        /// Amplitude b at the suction valve, over the line's pressure.
        pub suction: S,
        /// Amplitude b at the discharge valve, over the line's pressure.
        pub discharge: S,
    }
}

impl<S: Scalar> Acts<S> for ValveFlutter<S> {
    #[inline(always)]
    fn line_pressures(&self, [suction, discharge]: [S; 2], at: &ChamberAt<S>) -> [S; 2] {
        let [intake, outlet] = at.since_opening().map(|angle| self.swing(angle / at.speed.abs()));
        [
            suction * (S::one() - self.suction * intake),
            discharge * (S::one() + self.discharge * outlet),
        ]
    }
}

impl<S: Scalar> ValveFlutter<S> {
    /// The oscillation s a time after the valve has opened; 0 before.
    #[inline(always)]
    fn swing(&self, time: S) -> S {
        let time = time.max(S::zero());
        let damped = (S::one() - self.damping_ratio * self.damping_ratio).sqrt();
        let (sine, _) = (self.natural_frequency * damped * time).sin_cos();
        (-(self.damping_ratio * self.natural_frequency * time)).exp() * sine
    }
}
