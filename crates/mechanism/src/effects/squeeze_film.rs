//! Oil that is squeezed out between journal and bearing: the squeeze force of the short bearing's
//! full film (DuBois and Ocvirk 1953, NACA report 1157).
//!
//! ```text
//! F = −π μ R l³/c³ · (1 + 2 ε²) / (1 − ε²)^(5/2) · ė         ε = |e|/c
//! ```
//!
//! ė is the rate at which the journal approaches the bearing. The film ends at the height of the
//! roughness: 1 − ε² is rounded to √((1 − ε²)² + h²). The wedge that rotation makes is left out. A
//! film that fills a whole bearing is so stiff that nothing touches; `length` is what is wet.
//! Signature: impacts rounded and late, less ringing, more so the smaller the clearance.

use super::{Acts, JointAt};
use crate::lift::parameters;
use scalar::Scalar;
use std::f64::consts::PI;

parameters! {
    /// Parameters of the film.
    pub struct SqueezeFilm<S> {
        /// Viscosity μ of the oil, Pa s.
        pub viscosity: S,
        /// Length l of the film along the journal, m.
        pub length: S,
        /// Least value h of 1 − ε².
        pub roughness: S,
    }
}

impl<S: Scalar> Acts<S> for SqueezeFilm<S> {
    #[inline(always)]
    fn film_force(&self, at: &JointAt<S>) -> S {
        let e = at.penetration / at.clearance + 1.0;
        let gap = S::one() - e * e;
        let square = gap * gap + self.roughness * self.roughness;
        // ((1 − ε²)² + h²)^(5/4).
        let thin = square * square.sqrt().sqrt();
        let c = at.clearance;
        let oil = self.viscosity * at.journal_radius * self.length * self.length * self.length;
        let still = oil * PI / (c * c * c);
        -(still * (e * e * 2.0 + 1.0) / thin * at.rate)
    }
}
