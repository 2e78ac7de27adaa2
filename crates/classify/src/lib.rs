//! Gradient boosting of trees on tables of features, and what it says about them.
//!
//! [`domain_gap`] asks whether simulated windows can be told from measured ones, and by which features. [`baseline`] says
//! how well the classes of a dataset can be told apart: what a classifier of one's own is to be better than.
//! [`ranking`] says how well each feature does by itself.
//!
//! All results are the same for any number of threads.

mod area;
mod baseline;
mod bins;
mod boosting;
mod domain_gap;
mod folds;
mod matrix;
mod ranking;
mod tree;

pub use area::area_under_curve;
pub use baseline::{Baseline, ClassScore, baseline};
pub use boosting::Boosting;
pub use domain_gap::{DomainGap, TellingFeature, domain_gap};
pub use matrix::{Matrix, Sample};
pub use ranking::{RankedFeature, ranking};
