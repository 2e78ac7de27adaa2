//! A connecting rod that is elastic along its axis. It stretches evenly by η, a degree of freedom of its
//! own: a spring of stiffness k = E A / L between its eyes (the assumed mode of Rayleigh 1877).
//!
//! ```text
//! I (η̈ − (1 + η) φ̇²) = (L − a) u·F_small − a u·F_big − L² (k η + c η̇)
//! ```
//!
//! A shank whose eyes or bolts come to bear hardens: the spring's force is k L η (1 + q (η/10⁻⁴)²).
//!
//! u is the direction of the rod, a the distance of its centre of mass from the big end, and I its moment
//! of inertia about that. F are the forces on the rod at its ends. Between a fixed big end
//! and crosshead of mass m it swings with ω² = k L² / (I + M a² + m L²). Signature: ringing of a few
//! hundred Hz after every reversal, of one frequency at every speed.

use super::acts::{Acts, RodSpring};
use crate::declaration;
use crate::lift::parameters;
use scalar::Scalar;

parameters! {
    /// Parameters of the rod.
    pub struct RodFlexibility<S> {
        /// How much longer a force makes it, 1/k, m/N.
        pub compliance: S,
        /// Damping as a share of the critical one of the free rod.
        pub damping_ratio: S,
        /// By what share q the force is greater than that of a linear spring where the rod is 10⁻⁴ longer.
        pub hardening: S,
    }
}

declaration! {
    /// A connecting rod that is a spring along its axis.
    RodFlexibility at [Throw], RunningGear:
    "The connecting rod springs along its length: after every change of load it rings at one and the same pitch."
    law "rod stretches evenly: one more degree of freedom" after "Rayleigh 1877" {
        /// How much longer a force makes it: length / (Young's modulus × area of its shank).
        compliance: Compliance(FromZero), 3e-10 to 1e-7, start 5e-9, absent 0.0;
        /// Damping, of the critical one of the free rod; 2 % where it is left out.
        damping_ratio: Ratio(FromZero), 0.002 to 0.2, start 0.02;
        /// By what share the force is greater than that of a linear spring where the rod is a ten-thousandth longer; 0
        /// where it is left out.
        @shape hardening: Number(FromZero), 0.0 to 5.0, start 0.0;
    } as RodFlexibility
}

impl<S: Scalar> Acts<S> for RodFlexibility<S> {
    #[inline(always)]
    fn rod(&self) -> Option<RodSpring<S>> {
        Some(RodSpring {
            stiffness: S::one() / self.compliance,
            damping_ratio: self.damping_ratio,
            hardening: self.hardening,
        })
    }
}
