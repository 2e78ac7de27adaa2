//! Figures and pages, with made-up signals.

mod dataset_page;
mod figures;
mod synthetic;
