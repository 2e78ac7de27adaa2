//! Normal contact laws, one per file.
//!
//! All take the penetration δ (> 0 in contact), its rate δ̇, and the approach speed v₀ at the last
//! touch (only the laws with a coefficient of restitution use it). The force that the equations of
//! motion use is `max(0, raw)`: surfaces do not pull.
//!
//! A new law is a file here and a line in `contact_laws!`: a struct of parameters, its
//! `contact_law!`, and the methods of `Normal`. Section of the machine file, schema and tables
//! follow from these.

mod declaration;
mod factors;
mod normal;
mod restitution;

pub use declaration::{Declaration, Parameter, Surfaces};
pub(super) use factors::Factors;
pub use normal::{NormalForce, pressing};
pub use restitution::Restitution;

use crate::declaration::Clash;
use crate::lift::alternatives;
use crate::mode::ContactMode;
use declaration::contact_law;
use normal::{Normal, power};
use scalar::Scalar;

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
            law: |surfaces, values| $module::law(surfaces, values).map(ContactLaw::$kind),
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

/// A contact law of the list.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its name in the machine file.
    pub name: &'static str,
    /// What files, schemas and tables know of it.
    pub declaration: Declaration,
    /// The law with values of the parameters, SI, in their order.
    pub law: fn(&Surfaces, &[f64]) -> Result<ContactLaw, Clash>,
}

impl<S: Scalar> ContactLaw<S> {
    /// Elastic energy stored at penetration δ (m), J; 0 without contact.
    pub fn stored_energy(&self, penetration: S) -> S {
        let (stiffness, exponent) = self.spring();
        let one_more = exponent + 1.0;
        stiffness * power(penetration, exponent) * penetration.max(S::zero()) / one_more
    }
}
