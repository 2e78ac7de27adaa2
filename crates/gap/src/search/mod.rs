//! Which move comes next: effects are added one after another while they earn their place, and believed
//! where the recordings show them.

pub(crate) mod belief;
mod beside_wear;
pub(crate) mod gas;
pub(crate) mod last_rivals;
mod look_alike;
pub(crate) mod one_by_one;
mod refit;
mod replication;
pub(crate) mod throw_by_throw;
pub(crate) mod with_force;
