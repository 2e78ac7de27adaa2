//! Error-controlled integration of systems that are smooth between switches.
//!
//! A [`System`] is an ordinary differential equation whose right-hand side depends on a discrete
//! *mode* that the system keeps (which contacts are closed, which valves are open). Within a mode
//! the right-hand side is smooth, also a little beyond the mode's boundary. *Guards* are positive
//! inside the boundary. The [`Integrator`] takes steps of DOP853 with the mode frozen. It looks for the
//! first guard that crosses zero, ends the step there and lets the system switch. So no step
//! crosses a kink, and the order of the method holds throughout (measured in the tests).
//!
//! - [`dop853`]: one step, its error, its continuous extension;
//! - [`Integrator`]: step control, event location, observers;
//! - [`ensemble`]: many integrations side by side.

pub mod dop853;
pub mod ensemble;
mod events;
mod glance;
mod integrator;
mod system;
mod tableau;

pub use dop853::Step;
pub use ensemble::{Ensemble, Traveller};
pub use integrator::{Course, Error, Integrator, Trial, Work};
pub use system::{Real, System};
