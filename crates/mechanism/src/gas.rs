//! Gas force with ideal valves, single or double acting (MODEL.md, sections 3 and 6).

use crate::lift::parameters;

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
        /// Polytropic exponent m.
        pub exponent: S,
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
