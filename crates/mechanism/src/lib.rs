//! The machine: geometry, joints, gas, drive and the equations of motion, written once over the
//! number trait.
//!
//! - [`machine`]: the parameters, as plain data;
//! - [`joints`]: the four places with clearance, their contact and friction laws;
//! - [`gas`], [`drive`], [`frame`], [`housing`], [`effects`]: what else acts; [`declaration`](mod@declaration): what an effect says
//!   of itself;
//! - [`throw`] and [`shaft`]: forces and accelerations of one throw, and what couples them;
//! - [`state`] and [`mode`]: what is integrated, and what switches;
//! - [`dynamics`]: all of it together, [`SideBySide`] for several machines at once; [`energy`]: the
//!   ledger that must balance.

pub mod declaration;
pub mod drive;
pub mod dynamics;
pub mod effects;
pub mod energy;
mod evaluation;
pub mod frame;
pub mod gas;
pub mod housing;
mod impact;
pub mod joints;
pub mod lift;
pub mod machine;
pub mod mode;
pub mod plane;
mod scales;
pub mod shaft;
mod side_by_side;
pub mod state;
mod system;
pub mod throw;
mod watch;

pub use dynamics::Dynamics;
pub use evaluation::{Evaluation, ThrowEvaluation};
pub use machine::{Crankshaft, Crosshead, Direction, Machine, Rod, Throw};
pub use side_by_side::SideBySide;

/// Standard gravity, m/s² (3rd CGPM, 1901).
pub const GRAVITY: f64 = 9.806_65;
