//! Gas force with ideal valves, single or double acting (MODEL.md, sections 3 and 6).

mod chamber;
mod cylinder;
mod cylinder_at;
mod held;
mod throw_gas;

pub use chamber::GasState;
pub use cylinder::{CrankEnd, Cylinder};
pub(crate) use cylinder_at::CylinderAt;
pub use throw_gas::Gas;
