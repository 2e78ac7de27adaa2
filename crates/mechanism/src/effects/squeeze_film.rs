//! Oil that is squeezed out between journal and bearing: the squeeze force of the short bearing's
//! full film (DuBois and Ocvirk 1953, NACA report 1157).
//!
//! ```text
//! F = −π μ R l³/c³ · (1 + 2 ε²) / (1 − ε²)^(5/2) · ė         ε = |e|/c
//! ```
//!
//! A bearing that is long beside its radius has the film of Sommerfeld's, which grows as 1/(1 − ε²)^(3/2) (Booker 1965):
//! a share m of the force at ε = 0 may be of that kind.
//!
//! ė is the rate at which the journal approaches the bearing. While it leaves, a share s of that force is left:
//! a film that cannot pull has none (Gümbel 1914), one that is fed with oil all around has all of it. The film ends at the height of the
//! roughness, and stays so thin where the metal touches: 1 − ε² is no less than h, rounded over a fifth of it. The wedge that rotation makes is left out. A
//! film that fills a whole bearing is so stiff that nothing touches; `length` is what is wet.
//! Signature: impacts rounded and late, less ringing, more so the smaller the clearance.

use super::acts::{Acts, JointAt};
use crate::declaration;
use crate::lift::parameters;
use scalar::Scalar;
use std::f64::consts::PI;

/// Speed over which a film that leaves the bearing tears, m/s; blows have a hundredth of a metre per second and more.
const TEARS: f64 = 1e-3;
/// Share of the roughness over which the film comes to its end.
const ROUNDED: f64 = 0.2;

parameters! {
    /// Parameters of the film.
    pub struct SqueezeFilm<S> {
        /// Viscosity μ of the oil, Pa s.
        pub viscosity: S,
        /// Length l of the film along the journal, m.
        pub length: S,
        /// Least value h of 1 − ε².
        pub roughness: S,
        /// Share s of the force that is left while the journal leaves the bearing.
        pub separation: S,
        /// Share m of the force at the centre that is a long bearing's.
        pub long: S,
    }
}

declaration! {
    /// Squeeze force of the oil in a joint with clearance (short bearing); nothing in an ideal joint.
    SqueezeFilm at [Throw, Joint], Joint:
    "Oil in the bearing is squeezed out before the metal touches: the blows come late and soft."
    law "−π μ R l³/c³ (1 + 2ε²)/(1 − ε²)^(5/2) ė" after "DuBois and Ocvirk 1953" {
        /// Viscosity of the oil.
        viscosity: Viscosity(FromZero), 1e-4 to 0.2, start 0.02, absent 0.0;
        /// Length of the film along the journal: a film as long as the bearing is so stiff that
        /// nothing touches. 2 mm where it is left out.
        length: Length(AboveZero), 0.0005 to 0.05, start 0.002;
        /// Share of the clearance that the roughness keeps open; 0.1 where it is left out.
        roughness: Number(AboveZero), 0.01 to 0.5, start 0.1;
        /// Share of the force that is left while the journal leaves the bearing, 0 to 1; 1 where it is left out.
        @shape separation: Number(FromZero), 0.0 to 1.0, start 1.0;
        /// Share of the force at the centre that is a long bearing's, which grows less toward contact, 0 to 1; 0 where it is
        /// left out.
        @shape long: Number(FromZero), 0.0 to 1.0, start 0.0;
    } as SqueezeFilm
}

impl<S: Scalar> Acts<S> for SqueezeFilm<S> {
    #[inline(always)]
    fn film_force(&self, at: &JointAt<S>) -> S {
        let e = at.penetration / at.clearance + 1.0;
        let above = S::one() - e * e - self.roughness;
        let round = self.roughness * ROUNDED;
        let gap = self.roughness + (above + (above * above + round * round).sqrt()) * 0.5;
        let root = gap.sqrt();
        let thin = gap * gap * root;
        let thin_of_long = gap * root;
        let c = at.clearance;
        let oil = self.viscosity * at.journal_radius * self.length * self.length * self.length;
        let still = oil * PI / (c * c * c);
        let away = S::one() - at.rate / (at.rate * at.rate + TEARS * TEARS).sqrt();
        let rate = at.rate * (S::one() - away * (S::one() - self.separation) * 0.5);
        let short = still * (S::one() - self.long) * (e * e * 2.0 + 1.0) / thin;
        let long = still * self.long / thin_of_long;
        -((short + long) * rate)
    }
}
