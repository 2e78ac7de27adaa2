//! Normal contact laws, one per file.
//!
//! All take the penetration δ (> 0 in contact), its rate δ̇, and the approach speed v₀ at the last
//! touch (only the laws with a coefficient of restitution use it). The force that the equations of
//! motion use is `max(0, raw)`: surfaces do not pull.
//!
//! A new law is a file here, a variant and an arm in each `match` below.

mod flores;
mod hertz;
mod hunt_crossley;
mod impact;
mod kelvin_voigt;
mod lankarani_nikravesh;
mod restitution;

pub use hertz::Hertz;
pub use impact::Impact;
pub use kelvin_voigt::KelvinVoigt;
pub use restitution::Restitution;

use crate::lift::alternatives;
use crate::mode::ContactMode;
use scalar::{Mask, Scalar};

alternatives! {
    /// Which normal contact law a joint has.
    pub enum ContactLaw<S> {
        /// ADAMS IMPACT: elastic force with damping that grows in over a depth.
        Impact(Impact),
        /// Elastic force alone.
        Hertz(Hertz),
        /// Linear spring and damper.
        KelvinVoigt(KelvinVoigt),
        /// Hunt and Crossley 1975: χ = 3 (1 − e) / 2.
        HuntCrossley(Restitution),
        /// Lankarani and Nikravesh 1990: χ = 3 (1 − e²) / 4.
        LankaraniNikravesh(Restitution),
        /// Flores et al. 2011: χ = 8 (1 − e) / (5 e).
        Flores(Restitution),
    }
}

/// A normal force and the part of it that is stored and given back.
#[derive(Clone, Copy, Debug)]
pub struct NormalForce<S> {
    /// Elastic and dissipative force together, N; may be negative (see the module's page).
    pub raw: S,
    /// The elastic part, N.
    pub elastic: S,
    /// `raw / elastic − 1`, continued beyond the surface, as numerator and denominator: only guards need
    /// the quotient ([`pressing`]).
    pub excess: [S; 2],
}

/// Positive while surfaces of this excess press. Unlike the force it does not vanish where they part, so
/// that its sign change can be located.
#[inline(always)]
pub fn pressing<S: Scalar>([above, below]: [S; 2]) -> S {
    above / below + 1.0
}

impl<S: Scalar> NormalForce<S> {
    /// No contact.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Self {
            raw: S::zero(),
            elastic: S::zero(),
            excess: [S::zero(), S::one()],
        }
    }

    /// An elastic force with a damping force beside it.
    #[inline(always)]
    fn damped(elastic: S, damping: S) -> Self {
        Self {
            raw: elastic + damping,
            elastic,
            excess: [damping, elastic.max(S::constant(1e-200))],
        }
    }
}

impl<S: Scalar> ContactLaw<S> {
    /// The force at penetration δ (m) and rate δ̇ (m/s), in the contact's mode (approach speed, and
    /// which side of the law's kink).
    #[inline(always)]
    pub fn force(&self, penetration: S, rate: S, mode: &ContactMode<S>) -> NormalForce<S> {
        let approach = mode.approach;
        match self {
            ContactLaw::Impact(law) => law.force(penetration, rate, mode.deep),
            ContactLaw::Hertz(law) => law.force(penetration),
            ContactLaw::KelvinVoigt(law) => law.force(penetration, rate),
            ContactLaw::HuntCrossley(law) => {
                let factor = hunt_crossley::hysteresis(law.restitution);
                law.force(penetration, rate, approach, factor)
            }
            ContactLaw::LankaraniNikravesh(law) => {
                let factor = lankarani_nikravesh::hysteresis(law.restitution);
                law.force(penetration, rate, approach, factor)
            }
            ContactLaw::Flores(law) => {
                let factor = flores::hysteresis(law.restitution);
                law.force(penetration, rate, approach, factor)
            }
        }
    }

    /// Elastic energy stored at penetration δ (m), J; 0 without contact.
    pub fn stored_energy(&self, penetration: S) -> S {
        let (stiffness, exponent) = self.spring();
        let one_more = exponent + 1.0;
        stiffness * power(penetration, exponent) * penetration.max(S::zero()) / one_more
    }

    /// Stiffness K, N/mⁿ, and exponent n.
    pub fn spring(&self) -> (S, S) {
        match self {
            ContactLaw::Impact(law) => (law.stiffness, law.exponent),
            ContactLaw::Hertz(law) => (law.stiffness, law.exponent),
            ContactLaw::KelvinVoigt(law) => (law.stiffness, S::one()),
            ContactLaw::HuntCrossley(law)
            | ContactLaw::LankaraniNikravesh(law)
            | ContactLaw::Flores(law) => (law.stiffness, law.exponent),
        }
    }

    /// True where the force depends on the approach speed at the last touch.
    pub(crate) fn remembers(&self) -> bool {
        match self {
            ContactLaw::Impact(_) | ContactLaw::Hertz(_) | ContactLaw::KelvinVoigt(_) => false,
            ContactLaw::HuntCrossley(_)
            | ContactLaw::LankaraniNikravesh(_)
            | ContactLaw::Flores(_) => true,
        }
    }

    /// The penetration at which the law has a kink of its own, m: IMPACT's damping depth.
    #[inline(always)]
    pub fn kink(&self) -> Option<S> {
        match self {
            ContactLaw::Impact(law) => Some(law.depth),
            _ => None,
        }
    }
}

/// δⁿ for δ > 0, and 0 elsewhere. The common n = 1.5 costs a square root.
#[inline(always)]
pub(crate) fn power<S: Scalar>(penetration: S, exponent: S) -> S {
    let positive = penetration.max(S::zero());
    let root = positive * positive.sqrt();
    // Equal in its derivatives too: an exponent that varies about 1.5 goes the long way.
    if exponent == S::constant(1.5) {
        return root;
    }
    // Smaller than any penetration that matters, and still a normal number.
    let safe = positive.max(S::constant(1e-150));
    let half = exponent - 1.5;
    let other = half.lt(S::zero()).or(S::zero().lt(half));
    // At 1.5 the value of the root, to the bit, with the derivative δⁿ ln δ.
    let near = root * (half * safe.ln() + 1.0);
    let power = S::select(other, safe.powf(exponent), near);
    S::select(S::zero().lt(positive), power, S::zero())
}
