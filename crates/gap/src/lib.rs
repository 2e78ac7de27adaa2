//! Finds where a calibrated model and recordings disagree, which physical effect is missing, and by
//! how much it closes the gap.
//!
//! ```text
//! recordings ─┐
//!             ├─calibrate─> residual ─screening─> candidates ─refit─> decision ──> model + effect
//! machine ────┘                ^                                                       │
//!                              └────────────── until the noise is reached <────────────┘
//! ```

mod belief;
mod beside_wear;
pub mod candidate;
mod confusability;
pub mod decision;
pub mod empirical_force;
pub mod error;
pub mod explain;
pub mod journal;
mod last_rivals;
mod linearised;
mod look_alike;
pub mod mains_hum;
mod measuring_chain;
pub mod missing_force;
pub mod model;
mod named_instead;
mod next_recording;
mod pressures;
mod probes;
mod projector;
mod recorded_values;
mod refit;
mod replication;
pub mod residual_map;
pub mod scaling;
pub mod screening;
mod stability_selection;
pub mod steps;
mod throw_by_throw;

pub use candidate::Candidate;
pub use confusability::Likeness;
pub use decision::{Evidence, Verdict};
pub use empirical_force::{Force, Law, empirical_force};
pub use error::Error;
pub use explain::{Explanation, Found, Stage, Tried, explain, first_item};
pub use journal::Journal;
pub use mains_hum::{Hum, remove_hum};
pub use missing_force::MissingForce;
pub use model::{Effort, Model};
pub use residual_map::{Place, ResidualMap, band_names, places, residual_maps};
pub use scaling::{Scaling, scaling};
pub use steps::{Gap, Step};
