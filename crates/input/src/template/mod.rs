//! Files to fill in: trees with the words of their schema as comments, so that neither can go stale.

mod bundle;
mod calibration;
mod comments;
mod machine;

pub use bundle::{Recorded, bundle};
pub use calibration::calibration;
pub use comments::{Commented, commented};
pub use machine::{Asked, machine};
