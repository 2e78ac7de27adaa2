//! Figures and self-contained pages from plain structs.
//!
//! - [`figure`]: panels with lines, points and areas as SVG;
//! - [`case_picture`]: the picture of one simulated case;
//! - [`dataset_page`]: the HTML page of a dataset;
//! - [`chaos_page`]: the HTML page of what a sweep says about chaos;
//! - [`features_page`]: the HTML page that documents the features;
//! - [`calibration_page`]: the HTML page of a calibration;
//! - [`gap_page`]: the HTML page of an explanation;
//! - [`text`]: numbers with units, words, escaping.
//!
//! Structs go in, text comes out: nothing here reads or writes a file, and the same structs always
//! give the same bytes. Pages load nothing from anywhere.
//!
//! The figures are drawn by a module of our own. Of the plotting crates, kuva 0.6 was tried: its
//! grids hide the tick labels of panels that then do not have the common range, equal axes come
//! out lopsided, angles get ticks at 100°, and a line of 2 400 points takes 47 kB at any size.

pub mod calibration_page;
pub mod case_picture;
pub mod chaos_page;
pub mod classes;
pub mod dataset_page;
pub mod features_page;
pub mod figure;
pub mod gap_page;
mod level;
mod plate;
mod revolutions;
mod statistics;
pub mod text;

pub use level::Level;
pub use plate::{FigureFile, Rendered};

/// What can go wrong in making a page.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The template could not be filled in.
    #[error("the page could not be written: {0}")]
    Template(#[from] askama::Error),
}
