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
pub mod candidate;
mod conditions;
pub mod criteria;
pub mod effort;
pub mod error;
pub mod explain;
mod expression;
pub mod far_starts;
mod finding;
pub mod fitter;
#[cfg(test)]
mod fixture;
pub mod folder;
mod force;
mod form;
mod gas;
mod hypothesis;
pub mod journal;
mod judgement;
mod linearised;
pub mod mains_hum;
mod measuring_chain;
mod missing_force;
pub mod model;
mod next_recording;
mod notes;
pub mod parts;
mod places;
mod probes;
mod projector;
mod recorded;
mod recorded_values;
pub mod residual_map;
pub mod results;
pub mod scaling;
mod screen;
mod search;
mod stability_selection;
pub mod steps;
mod summary;
mod trial;

pub use amendment::Amendment;
pub use candidate::Candidate;
pub use criteria::{Evidence, Verdict};
pub use effort::Effort;
pub use error::Error;
pub use explain::{Explanation, Stage, explain};
pub use finding::{Correction, Found, Tried, first_item};
pub use folder::{Asked, into_folder};
pub use journal::Journal;
pub use mains_hum::{Hum, remove_hum};
pub use missing_force::MissingForce;
pub use model::{Gap, Model};
pub use parts::ByPart;
pub use recorded::Recorded;
pub use residual_map::{Place, ResidualMap, band_names, places, residual_maps};
pub use results::Results;
pub use scaling::{Scaling, scaling};
pub use steps::Step;
