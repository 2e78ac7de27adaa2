//! The frame: a rigid mass on springs and dampers along x and y, shaken by the machine.
//!
//! ```text
//! M ẍ + C ẋ + K x = F(t)         along each direction
//! ```
//!
//! F is all that the running gear puts on the frame: the main bearing's force, the guide's, and
//! the gas pressure on the cylinder's covers (which cancels the gas part of the bearing force).
//! The coupling is one-way: the frame's motion is taken as too small to act back.

use crate::lift::parameters;

parameters! {
    /// An elastically mounted frame.
    pub struct Frame<S> {
        /// Mass, kg.
        pub mass: S,
        /// Stiffness along x, N/m.
        pub stiffness_x: S,
        /// Stiffness along y, N/m.
        pub stiffness_y: S,
        /// Damping along x, N s/m.
        pub damping_x: S,
        /// Damping along y, N s/m.
        pub damping_y: S,
    }
}
