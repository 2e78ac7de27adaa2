//! Figures and pages, with made-up signals.

mod browser;
mod calibration_page;
mod case_picture;
mod chaos_page;
mod dataset_page;
mod features_page;
mod markup;
mod synthetic;
