//! Figures and pages, with made-up signals.

mod chaos_page;
mod dataset_page;
mod features_page;
mod figures;
mod synthetic;
