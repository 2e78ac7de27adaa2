//! What a contact law does, and the force that it gives.

use super::factors::Factors;
use crate::mode::ContactMode;
use scalar::{Mask, Scalar};

/// What a contact law does with its parameters.
pub(super) trait Normal<S: Scalar> {
    /// The parameters.
    type Of;

    /// The force at penetration δ (m) and rate δ̇ (m/s), in the contact's mode (approach speed, and
    /// which side of the law's kink).
    fn force(law: &Self::Of, penetration: S, rate: S, mode: &ContactMode<S>) -> NormalForce<S>;

    /// Stiffness K, N/mⁿ, and exponent n of the elastic part K δⁿ.
    fn spring(law: &Self::Of) -> (S, S);

    /// The law at another clearance, by the factors of a relation.
    fn carried_over(law: &Self::Of, factors: &Factors<S>) -> Self::Of;

    /// The penetration at which the law has a kink of its own, m.
    #[inline(always)]
    fn kink(_law: &Self::Of) -> Option<S> {
        None
    }

    /// True where the force depends on the approach speed at the last touch.
    fn remembers() -> bool {
        false
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
    pub(super) fn damped(elastic: S, damping: S) -> Self {
        Self {
            raw: elastic + damping,
            elastic,
            excess: [damping, elastic.max(S::constant(1e-200))],
        }
    }
}

/// δⁿ for δ > 0, and 0 elsewhere. The common n = 1.5 costs a square root.
#[inline(always)]
pub(super) fn power<S: Scalar>(penetration: S, exponent: S) -> S {
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
