//! Finds where a calibrated model and recordings disagree, which physical effect is missing, and by
//! how much it closes the gap.
//!
//! ```text
//! recordings ─┐
//!             ├─calibrate─> residual ─screening─> candidates ─refit─> decision ──> model + effect
//! machine ────┘                ^                                                       │
//!                              └────────────── until the noise is reached <────────────┘
//! ```

pub mod candidate;
pub mod criteria;
pub mod effort;
pub mod error;
pub mod explain;
mod expression;
pub mod finding;
pub mod fitter;
#[cfg(test)]
mod fixture;
pub mod folder;
pub mod journal;
pub mod mains_hum;
mod measuring_chain;
pub mod model;
mod moves;
mod next_recording;
mod notes;
mod recorded;
pub mod residual_map;
pub mod results;
pub mod scaling;
mod search;
pub mod steps;

pub use candidate::Candidate;
pub use criteria::{Evidence, Verdict};
pub use effort::Effort;
pub use error::Error;
pub use explain::{Explanation, Stage, explain};
pub use finding::{Found, Likeness, Tried, first_item};
pub use folder::{Asked, into_folder};
pub use journal::Journal;
pub use mains_hum::{Hum, remove_hum};
pub use model::{Gap, Model};
pub use moves::missing_force::MissingForce;
pub use residual_map::{Place, ResidualMap, band_names, places, residual_maps};
pub use results::Results;
pub use scaling::{Scaling, scaling};
pub use steps::Step;
