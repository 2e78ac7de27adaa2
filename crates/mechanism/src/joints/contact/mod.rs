//! Normal contact laws, one per file.
//!
//! All take the penetration δ (> 0 in contact), its rate δ̇, and the approach speed v₀ at the last
//! touch (only the laws with a coefficient of restitution use it). The force that the equations of
//! motion use is `max(0, raw)`: surfaces do not pull.
//!
//! A new law is a file here and a line in [`contact_laws!`]: a struct of parameters, its
//! [`contact_law!`], and the methods of [`Normal`]. Section of the machine file, schema and tables
//! follow from these.

mod declaration;
mod restitution;

pub use declaration::{Declaration, Entry, Parameter, Surfaces};
pub use restitution::Restitution;

use declaration::contact_law;

use super::clearance_relation::Factors;
use crate::lift::alternatives;
use crate::mode::ContactMode;
use scalar::{Mask, Scalar};

/// What a contact law does with its parameters.
trait Normal<S: Scalar> {
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

/// The one list of contact laws: it makes the modules, [`ContactLaw`] and its dispatch.
macro_rules! contact_laws {
    ($( $module:ident::$kind:ident, )*) => {
        $( mod $module; pub use $module::$kind; )*

        alternatives! {
            /// Which normal contact law a joint has.
            pub enum ContactLaw<S> {
                $( #[doc = concat!("See [`", stringify!($kind), "`].")] $kind($kind), )*
            }
        }

        /// All contact laws; the first is the default.
        pub const CONTACT_LAWS: &[Entry] = &[$( Entry {
            name: stringify!($module),
            declaration: $module::DECLARATION,
            law: |surfaces, values| $module::of(surfaces, values).map(ContactLaw::$kind),
        } ),*];

        impl<S: Scalar> ContactLaw<S> {
            /// The force at penetration δ (m) and rate δ̇ (m/s), in the contact's mode (approach
            /// speed, and which side of the law's kink).
            #[inline(always)]
            pub fn force(&self, penetration: S, rate: S, mode: &ContactMode<S>) -> NormalForce<S> {
                match self {
                    $( ContactLaw::$kind(law) => <$module::Law as Normal<S>>::force(law, penetration, rate, mode), )*
                }
            }

            /// Stiffness K, N/mⁿ, and exponent n.
            pub fn spring(&self) -> (S, S) {
                match self {
                    $( ContactLaw::$kind(law) => <$module::Law as Normal<S>>::spring(law), )*
                }
            }

            /// The law at another clearance, by the factors of a relation.
            pub(super) fn carried_over(&self, factors: &Factors<S>) -> Self {
                match self {
                    $( ContactLaw::$kind(law) => {
                        ContactLaw::$kind(<$module::Law as Normal<S>>::carried_over(law, factors))
                    } )*
                }
            }

            /// The penetration at which the law has a kink of its own, m: IMPACT's damping depth.
            #[inline(always)]
            pub fn kink(&self) -> Option<S> {
                match self {
                    $( ContactLaw::$kind(law) => <$module::Law as Normal<S>>::kink(law), )*
                }
            }

            /// True where the force depends on the approach speed at the last touch.
            pub(crate) fn remembers(&self) -> bool {
                match self {
                    $( ContactLaw::$kind(_) => <$module::Law as Normal<S>>::remembers(), )*
                }
            }
        }
    };
}

contact_laws! {
    impact::Impact,
    hertz::Hertz,
    kelvin_voigt::KelvinVoigt,
    hunt_crossley::HuntCrossley,
    lankarani_nikravesh::LankaraniNikravesh,
    flores::Flores,
    cylinder::Cylinder,
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
    /// Elastic energy stored at penetration δ (m), J; 0 without contact.
    pub fn stored_energy(&self, penetration: S) -> S {
        let (stiffness, exponent) = self.spring();
        let one_more = exponent + 1.0;
        stiffness * power(penetration, exponent) * penetration.max(S::zero()) / one_more
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
