//! The structure of the workspace: what `crates/README.md` promises, checked.
#![allow(missing_docs)]

mod arrows;
mod circles;
mod constants;
mod links;
mod sources;
