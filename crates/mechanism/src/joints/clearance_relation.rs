//! How contact parameters follow the clearance: a law that is known at one clearance becomes the
//! law of the same joint at another.
//!
//! An impact of mass m at speed v on `F = K δⁿ + STEP(δ, 0, 0, d, C) δ̇` reaches a depth
//! `δₘ ∝ (m v²/K)^(1/(n + 1))` (for n = 3/2 Hertz 1881; Johnson 1985, Contact Mechanics, section
//! 11.4). The dimensionless groups of the equation of motion are `d/δₘ` and `C δₘ/(m v)`, so that they
//! alone decide the restitution. Both keep their values, at every mass and speed, where
//!
//! ```text
//! d ∝ K^(−1/(n + 1)),  C ∝ K^(1/(n + 1))
//! ```
//!
//! so that the same materials give the same restitution. That is the conformal relation: with
//! n = 3/2 and the stiffness K ∝ c^(−1/2) of a journal in a bearing, d ∝ c^(1/5) and C ∝ c^(−1/5).
//!
//! Eq. (5) gives the stiffness alone, and that hardly depends on the clearance. With an equal
//! restitution no parameter would follow the clearance, and Eq. (5) would be a constant relation. Here
//! the damping follows the patch of contact, which is our choice. A journal lies in its bearing
//! conformally whichever formula gives the spring, and a wider clearance makes the patch smaller. So C
//! takes the power 1/(n + 1) of the conformal stiffness, c^(−1/5). The depth belongs to the surfaces
//! and stays.
//!
//! A linear spring (n = 1) keeps its damping ratio by the conformal relation. A coefficient of
//! restitution stays as it is. Friction does too: it does not depend on the clearance to first order.

use super::contact::{ContactLaw, Factors};
use super::stiffness::{effective_radius_conformal, effective_radius_eq5};
use scalar::Scalar;

/// A relation between the contact parameters of a joint at different clearances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Relation<S = f64> {
    /// The stiffness follows Eq. (5) of the papers, the damping the conformal patch of contact, the
    /// depth stays.
    Equation5,
    /// The stiffness follows the conformal form of Hertz 1881, damping and depth keep the
    /// restitution.
    Conformal,
    /// Nothing depends on the clearance.
    Constant,
    /// Powers of the clearance, as a fit finds them.
    Powers {
        /// Of the stiffness.
        stiffness: S,
        /// Of the damping.
        damping: S,
        /// Of IMPACT's depth.
        depth: S,
    },
}

impl<S: Scalar> Relation<S> {
    /// Factors from the first to the second of two clearances (m, both above 0) of a journal of
    /// radius `journal` (m), for a law with the exponent `exponent`.
    fn factors(&self, journal: S, clearances: [S; 2], exponent: S) -> Factors<S> {
        let power = |exponent: S| (clearances[1] / clearances[0]).powf(exponent);
        let of_radius = |radius: fn(S, S) -> S| {
            let [from, to] = clearances.map(|clearance| radius(journal, clearance));
            (to / from).sqrt()
        };
        let conformal = || of_radius(effective_radius_conformal);
        let of_patch = || conformal().powf(S::one() / (exponent + 1.0));
        match *self {
            Relation::Equation5 => Factors {
                stiffness: of_radius(|r, c| effective_radius_eq5([r, r + c])),
                damping: of_patch(),
                depth: S::one(),
            },
            Relation::Conformal => Factors {
                stiffness: conformal(),
                damping: of_patch(),
                depth: S::one() / of_patch(),
            },
            Relation::Constant => Factors {
                stiffness: S::one(),
                damping: S::one(),
                depth: S::one(),
            },
            Relation::Powers {
                stiffness,
                damping,
                depth,
            } => Factors {
                stiffness: power(stiffness),
                damping: power(damping),
                depth: power(depth),
            },
        }
    }
}

impl<S: Scalar> ContactLaw<S> {
    /// The law at the second of two clearances (m, both above 0), where this one holds at the
    /// first, of a journal of radius `journal` (m).
    #[must_use]
    pub fn at_clearance(&self, relation: &Relation<S>, journal: S, clearances: [S; 2]) -> Self {
        let (_, exponent) = self.spring();
        let factors = relation.factors(journal, clearances, exponent);
        self.carried_over(&factors)
    }
}
