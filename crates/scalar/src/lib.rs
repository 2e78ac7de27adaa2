//! One number trait for everything the equations of motion are evaluated with.
//!
//! - `f64`: an ordinary run;
//! - [`Dual`]: a value with its exact derivatives in `N` directions (over any other scalar);
//! - [`Lanes`]: several cases side by side, in a register of the processor's vector unit.
//!
//! The elementary functions are our own ([`elementary`]). The platform's C library may take
//! another path on another processor, and a chaotic run turns one different last bit into a
//! different recording. Every scalar calls the same code, so a case gives the same bytes alone,
//! in a lane, or as the value of a dual number.

pub mod dual;
pub mod elementary;
mod fused;
pub mod lanes;
mod number;
mod plain;
pub mod random;

pub use dual::Dual;
pub use lanes::{InLanes, Lanes, in_lanes};
pub use number::{Mask, Scalar, inlined};
