//! What a contact law says of itself, for files, schemas and tables.

use crate::declaration::{Quantity, Range};

/// The declaration of a contact law.
#[derive(Clone, Copy, Debug)]
pub struct Declaration {
    /// What it is.
    pub about: &'static str,
    /// What its key `stiffness` means; none where the law works the stiffness out.
    pub stiffness: Option<&'static str>,
    /// Its other parameters, in the order of its section.
    pub parameters: &'static [Parameter],
}

/// A parameter of a contact law.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its key.
    pub key: &'static str,
    /// What it means.
    pub words: &'static str,
    /// What it is a value of.
    pub quantity: Quantity,
    /// Which values it may have.
    pub range: Range,
    /// The value where it is left out, SI; none where it must be there.
    pub default: Option<f64>,
}

impl Parameter {
    /// What it is a value of, and which values it may have.
    pub fn declared(&self) -> (Quantity, Range) {
        (self.quantity, self.range)
    }
}

/// What a law is made from beside its parameters.
#[derive(Clone, Copy, Debug)]
pub struct Surfaces {
    /// Stiffness K, N/mⁿ.
    pub stiffness: f64,
    /// Radial clearance, m; 0 in an ideal joint.
    pub clearance: f64,
}

/// Declares a contact law. The module gets a type `Law`, `DECLARATION`, and, unless `by hand` follows,
/// `law`, which makes the parameters where the names of their fields are `stiffness` and the keys.
///
/// ```text
/// contact_law! {
///     /// What it is.
///     Name, stiffness "What the key `stiffness` means." {
///         /// What the parameter means.
///         key: Quantity(Range);                  // must be there
///         key: Quantity(Range), or value;        // the default
///     }
/// }
/// ```
macro_rules! contact_law {
    (
        $(#[doc = $about:literal])+
        $name:ident, $(stiffness $stiffness:literal)? $(by $hand:ident)? {
            $( $(#[doc = $words:literal])+ $key:ident: $quantity:ident($range:expr) $(, or $default:literal)?; )+
        }
    ) => {
        /// The law: see the module's page.
        pub(super) struct Law;

        /// What files, schemas and tables know of the law.
        pub(super) const DECLARATION: super::Declaration = {
            #[allow(unused_imports)]
            use crate::declaration::{Quantity, Range::*};
            super::Declaration {
                about: concat!($($about),+).trim_ascii(),
                stiffness: super::contact_law!(@option $($stiffness)?),
                parameters: &[$( super::Parameter {
                    key: stringify!($key),
                    words: concat!($($words),+).trim_ascii(),
                    quantity: Quantity::$quantity,
                    range: $range,
                    default: super::contact_law!(@option $($default)?),
                } ),+],
            }
        };

        super::contact_law! { @law $name [$($key)+] $($hand)? }
    };

    (@option) => { None };
    (@option $value:literal) => { Some($value) };
    (@law $name:ident [$($key:ident)+]) => {
        /// The parameters with these values.
        pub(super) fn law(
            surfaces: &super::Surfaces,
            values: &[f64],
        ) -> Result<$name, crate::declaration::Clash> {
            let mut values = values.iter().copied();
            Ok($name {
                stiffness: surfaces.stiffness,
                $( $key: values.next().unwrap_or_default(), )+
            })
        }
    };
    (@law $name:ident [$($key:ident)+] hand) => {};
}

pub(super) use contact_law;
