//! The pages of a dataset, from its tables.

mod about;
mod cases;
mod chaos_page;
mod columns;
mod dataset_page;
mod features_page;
