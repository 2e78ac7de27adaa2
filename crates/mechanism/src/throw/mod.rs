//! One throw: from the crank pin's motion and the joints' offsets to forces and accelerations.
//!
//! Everything here is in the throw's own frame: x toward its head, origin at the shaft's ideal
//! axis. Two steps, because the crank's acceleration may depend on every throw:
//!
//! 1. [`Motion`] and `Loads`: poses, rates, and every force that follows from them.
//! 2. `Response`: the unknown forces of rigid joints as an affine function of the crank pin's
//!    acceleration, by eliminating the small end, then the big end. A joint with clearance has no
//!    unknown force, so with both ends clear nothing is solved at all.

mod accelerations;
mod joints;
mod loads;
mod motion;
mod response;
mod rod_spring;

pub use accelerations::Accelerations;
pub use joints::Joints;
pub(crate) use loads::{Loads, following_target};
pub use motion::Motion;
pub(crate) use response::Response;
