//! The tests of gap, in one program.

mod gas;
mod small_gap;
