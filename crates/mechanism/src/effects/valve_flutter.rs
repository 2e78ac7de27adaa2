//! A valve whose plate sticks and then swings on its spring: it lets go late, when the gas has passed the
//! line's pressure by a share b, and until the plate has come to rest the pressure in the cylinder swings about
//! the line's (Costagliola 1950, whose plate of mass m on a spring k has the natural frequency
//! ω = √(k/m); here as a damped oscillation of its own, which the flow does not change).
//!
//! ```text
//! suction valve open: p = ps (1 − b s(t))      discharge valve open: p = pd (1 + b s(t))
//! s(t) = e^(−ζ ω t) (cos ν t + ζ ω/ν sin ν t),  ν = √(1 − ζ²) ω;  1 before t = 0
//! ```
//!
//! s is the way back of a damped oscillator that is let go. The time runs from the angle at which the
//! polytrope of an ideal piston reaches the pressure at which the valve lets go. Signature: an overshoot at each
//! opening and a ripple on the plateau behind it, of the same frequency in Hz at every speed, from an angle
//! that moves with the ratio of the pressures.

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
        /// Overshoot b at the suction valve, over the line's pressure.
        pub suction: S,
        /// Overshoot b at the discharge valve, over the line's pressure.
        pub discharge: S,
    }
}

impl<S: Scalar> Acts<S> for ValveFlutter<S> {
    #[inline(always)]
    fn line_pressures(&self, [suction, discharge]: [S; 2], at: &ChamberAt<S>) -> [S; 2] {
        let opened = [S::one() - self.suction, S::one() + self.discharge];
        let since = at.since_opening(opened);
        let [intake, outlet] = since.map(|angle| self.swing(angle / at.speed.abs()));
        [
            suction * (S::one() - self.suction * intake),
            discharge * (S::one() + self.discharge * outlet),
        ]
    }
}

impl<S: Scalar> ValveFlutter<S> {
    /// The oscillation s a time after the valve has let go.
    #[inline(always)]
    fn swing(&self, time: S) -> S {
        let time = time.max(S::zero());
        let slower = (S::one() - self.damping_ratio * self.damping_ratio).sqrt();
        let (sine, cosine) = (self.natural_frequency * slower * time).sin_cos();
        let decay = (-(self.damping_ratio * self.natural_frequency * time)).exp();
        decay * (cosine + self.damping_ratio / slower * sine)
    }
}
