//! The tests of integrate, in one program.

mod bounces;
mod order;
