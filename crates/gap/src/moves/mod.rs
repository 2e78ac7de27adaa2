//! What may be proposed: candidates that are worth a fit, what is like them, and a force of no name.

pub(crate) mod force;
pub(crate) mod force_match;
mod linearised;
pub(crate) mod missing_force;
mod probes;
mod projector;
mod recorded_values;
pub(crate) mod screen;
pub(crate) mod signature;
mod stability_selection;
