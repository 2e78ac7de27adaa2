//! Cylinder, piston and gas as plain data.

use crate::lift::parameters;
use scalar::Scalar;
use std::f64::consts::PI;

parameters! {
    /// Cylinder, piston and gas of one throw.
    pub struct Cylinder<S> {
        /// Piston radius, m.
        pub piston_radius: S,
        /// Suction pressure ps, absolute, Pa.
        pub suction: S,
        /// Discharge pressure pd, absolute, Pa.
        pub discharge: S,
        /// Pressure pb behind a single-acting piston, and on the end of a double-acting one's
        /// rod, absolute, Pa.
        pub back: S,
        /// Polytropic exponent m of the compression.
        pub exponent: S,
        /// Polytropic exponent of the expansion of what stays in the clearance. MODEL.md has one
        /// exponent for both; in a real cylinder heat and leakage make them differ.
        pub expansion_exponent: S,
        /// Clearance S0 between piston and head at top dead centre, m.
        pub head_clearance: S,
        /// The crank-end chamber of a double-acting cylinder.
        pub crank_end: Option<CrankEnd<S>>,
    }
}

parameters! {
    /// The second chamber of a double-acting cylinder.
    pub struct CrankEnd<S> {
        /// Piston-rod radius, m.
        pub rod_radius: S,
        /// Clearance S0c between piston and crank-end cover at bottom dead centre, m.
        pub clearance: S,
    }
}

/// Area of a disc, m².
#[inline(always)]
pub(super) fn area<S: Scalar>(radius: S) -> S {
    radius * radius * PI
}
