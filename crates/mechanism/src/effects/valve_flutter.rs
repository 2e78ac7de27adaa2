//! A valve whose plate sticks and then swings on its spring. It lets go late, when the gas has passed the
//! line's pressure by a share b. Until the plate is at rest, the pressure in the cylinder swings about the
//! line's. In Costagliola 1950 a plate of mass m on a spring k has the natural frequency ω = √(k/m). Here
//! it is a damped oscillation that the flow does not change.
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

use super::acts::{Acts, ChamberAt};
use super::alternatives::Alternatives;
use crate::declaration;
use crate::lift::parameters;
use scalar::{Scalar, inlined};
use std::f64::consts::TAU;

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

declaration! {
    /// Valves that open late, and a damped swing of the cylinder's pressure about the line's after it.
    ValveFlutter at [Throw, End], Gas:
    "The valves open late and flutter: the pressure overshoots and then ripples, always at the same pitch, until the plate has come to rest."
    law "valves open a share b late, then p = line × (1 ± b e^(−ζωt) cos ωt), t since they opened" after "Costagliola 1950" {
        /// Natural frequency of the plates; 100 Hz where it is left out.
        frequency: Frequency(AboveZero), 20.0 to 2000.0, start 100.0;
        /// Damping, of the critical one; 5 % where it is left out.
        damping_ratio: Ratio(ProperPart), 0.005 to 0.7, start 0.05;
        /// Overshoot at the suction valve, of the line's pressure.
        suction: Ratio(ProperPart), 0.002 to 0.3, start 0.05, absent 0.0;
        /// Overshoot at the discharge valve, of the line's pressure.
        discharge: Ratio(FromZero), 0.002 to 0.3, start 0.05, absent 0.0;
    }
}

/// The law with these values.
pub fn law(values: &[f64], _: Alternatives) -> ValveFlutter {
    let values = Values::new(values);
    ValveFlutter {
        natural_frequency: TAU * values.frequency,
        damping_ratio: values.damping_ratio,
        suction: values.suction,
        discharge: values.discharge,
    }
}

impl<S: Scalar> Acts<S> for ValveFlutter<S> {
    #[inline(always)]
    fn line_pressures(&self, [suction, discharge]: [S; 2], at: &ChamberAt<S>) -> [S; 2] {
        let opened = [S::one() - self.suction, S::one() + self.discharge];
        let since = at.since_opening(opened);
        let swing = inlined(
            #[inline(always)]
            |angle: S| self.swing(angle / at.speed.abs()),
        );
        [
            suction * (S::one() - self.suction * swing(since[0])),
            discharge * (S::one() + self.discharge * swing(since[1])),
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
