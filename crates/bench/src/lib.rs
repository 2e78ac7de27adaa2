//! The proof of the explanation of gaps, on recordings whose truth is known.
//!
//! Each case goes through the disk: a bundle is made, the explanation is given its folder and nothing
//! else, and what it finds is held against what was hidden.

mod case;
pub mod error;
pub mod machine;
pub mod matrix;
pub mod outcome;
pub mod outside;
pub mod plan;
pub mod recordings;
pub mod settings;
mod truth;

pub use case::Bench;
pub use error::Error;
pub use machine::Machine;
pub use matrix::Matrix;
pub use outcome::{Ledger, Outcome};
pub use outside::Outside;
pub use plan::{Case, NOTHING, cases, chosen, listed};
pub use recordings::Recorder;
pub use settings::HiddenEffects;
