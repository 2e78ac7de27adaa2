//! Friction laws, one per file. Each gives the coefficient μ(v) by which the normal force is
//! multiplied, with the sign of the slip speed v (m/s), so that `F_T = μ(v) F_N` opposes the slip.
//!
//! A new law is a file here, a variant and an arm in each `match` below.

mod adams;
mod ambrosio;
mod coulomb;
mod frictionless;

pub use adams::Adams;
pub use ambrosio::Ambrosio;
pub use coulomb::Coulomb;
pub use frictionless::Frictionless;

use crate::lift::alternatives;
use scalar::Scalar;

alternatives! {
    /// Which friction law a joint has.
    pub enum FrictionLaw<S> {
        /// Smooth surfaces.
        None(Frictionless),
        /// Coulomb's law, regularised.
        Coulomb(Coulomb),
        /// Static and dynamic coefficient with transition speeds, as in ADAMS.
        Adams(Adams),
        /// Ambrósio 2003.
        Ambrosio(Ambrosio),
    }
}

impl<S: Scalar> FrictionLaw<S> {
    /// No friction.
    pub fn none() -> Self {
        FrictionLaw::None(Frictionless {
            coefficient: S::zero(),
        })
    }

    /// Coefficient μ at slip speed `slip`, m/s, with its sign.
    #[inline(always)]
    pub fn coefficient(&self, slip: S) -> S {
        match self {
            FrictionLaw::None(law) => law.coefficient,
            FrictionLaw::Coulomb(law) => law.coefficient(slip),
            FrictionLaw::Adams(law) => law.coefficient(slip),
            FrictionLaw::Ambrosio(law) => law.coefficient(slip),
        }
    }

    /// The slip speeds at which the law has a kink, m/s.
    #[inline(always)]
    pub fn kinks(&self) -> Option<[S; 2]> {
        match self {
            FrictionLaw::None(_) | FrictionLaw::Coulomb(_) => None,
            FrictionLaw::Adams(law) => Some([law.stiction_speed, law.transition_speed]),
            FrictionLaw::Ambrosio(law) => Some([law.slow, law.fast]),
        }
    }
}
