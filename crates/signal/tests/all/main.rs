//! The tests of signal, in one program.

mod properties;
mod scipy;
