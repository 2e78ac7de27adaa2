//! The pages of a dataset, from its tables.

mod about;
mod baseline;
mod cases;
mod chaos;
mod columns;
mod counts;
mod dataset_page;
mod examples;
mod features;
mod features_page;
mod grid;
mod operating_points;
mod operation;
mod random;
mod ranking;
pub(crate) mod recording;
mod scatter;
pub(crate) mod words;
