//! The tests of recordings, in one program.

mod measured;
mod readers;
#[path = "../../../../tests/readers/venv.rs"]
mod venv;
