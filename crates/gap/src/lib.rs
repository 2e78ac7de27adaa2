//! Finds where a calibrated model and recordings disagree, which physical effect is missing, and by
//! how much it closes the gap.
//!
//! ```text
//! recordings ─┐
//!             ├─calibrate─> machine ─screening─> amendments ─fits─> sets ─judgement─> machine + effects
//! machine ────┘                ^                                     │
//!                              └──────────── best set first <────────┘
//! ```

pub mod amendment;
pub mod criteria;
pub mod error;
pub mod explain;
mod finding;
pub mod fitter;
#[cfg(test)]
mod fixture;
pub mod folder;
mod force;
mod gas;
pub mod mains_hum;
mod measuring_chain;
pub mod model;
mod recorded;
pub mod results;
mod search;
pub mod steps;

pub use amendment::Amendment;
pub use amendment::candidate::Candidate;
pub use criteria::{Evidence, Verdict};
pub use error::Error;
pub use explain::{Explanation, Stage, explain};
pub use finding::{Correction, Found, Tried, first_item};
pub use fitter::effort::Effort;
pub use fitter::journal::Journal;
pub use folder::{Asked, into_folder};
pub use force::missing_force::MissingForce;
pub use mains_hum::{Hum, remove_hum};
pub use model::{Gap, Model};
pub use recorded::Recorded;
pub use results::Results;
pub use results::parts::ByPart;
pub use results::residual_map::{Place, ResidualMap, band_names, places, residual_maps};
pub use results::scaling::{Scaling, scaling};
pub use steps::Step;
