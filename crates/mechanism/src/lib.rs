//! The machine: geometry, joints, gas, drive and the equations of motion, written once over the
//! number trait.

pub mod drive;
pub mod effects;
pub mod frame;
pub mod gas;
pub mod joints;
pub mod lift;
pub mod machine;

pub use machine::{Crankshaft, Crosshead, Direction, Machine, Rod, Throw};
