//! Smooth surfaces: μ = 0.

use crate::lift::parameters;

parameters! {
    /// The law without friction.
    pub struct Frictionless<S> {
        /// Always 0.
        pub coefficient: S,
    }
}
