//! Self-contained pages of what the other crates compute.
//!
//! - [`case_picture`]: the picture of one simulated case;
//! - [`case_table`]: the cases of a dataset, for the script of its page;
//! - [`case_view`]: one case simulated again, for a page;
//! - [`run_figures`], [`run_folder`]: p-V cards, rod loads and waveforms of one run, and all its files;
//! - [`summary`]: results in a few lines of plain text;
//! - [`dataset_page`]: the HTML page of a dataset;
//! - [`chaos_page`]: the HTML page of what a sweep says about chaos;
//! - [`comparison_page`]: the HTML page of two recordings or datasets side by side;
//! - [`domain_gap_page`]: the HTML page of simulated windows beside measured ones;
//! - [`features_page`]: the HTML page that documents the features;
//! - [`calibration_page`]: the HTML page of a calibration;
//! - [`gap_page`]: the HTML page of an explanation;
//! - [`wear_page`]: the HTML page of an estimation of wear;
//! - [`folder_page`], [`progress_page`]: the live pages of a folder and of a sweep under way;
//! - [`folder_kind`]: what a folder holds, and its pages by name.
//!
//! A page is a plain struct that renders itself. The same struct gives the same bytes, and a page
//! loads nothing from other places. Pages of a dataset are filled from a [`sweep::reader::Dataset`] with
//! what [`study`] computes of it; [`figure`] draws the figures.

pub mod calibration_page;
pub mod case_picture;
pub mod case_table;
pub mod case_view;
pub mod chaos_page;
mod class_colour;
mod column;
pub mod comparison_page;
mod dataset;
pub mod dataset_page;
pub mod domain_gap_page;
pub mod features_page;
mod files;
pub mod folder_kind;
pub mod folder_page;
pub mod gap_page;
mod histogram;
mod over_crank_angle;
mod plate;
pub mod progress_page;
mod refreshed;
mod revolutions;
pub mod run_figures;
pub mod run_folder;
pub mod summary;
pub mod wear_page;

pub use column::Column;
pub use files::{write_page, write_pages};
pub use plate::{FigureFile, Rendered};

use std::path::PathBuf;

/// What can go wrong in making a page.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The template could not be filled in.
    #[error("the page could not be written: {0}")]
    Template(#[from] askama::Error),
    /// The dataset cannot be read.
    #[error(transparent)]
    Dataset(#[from] sweep::reader::Error),
    /// The results of a calibration cannot be read.
    #[error(transparent)]
    Calibration(#[from] calibrate::Error),
    /// The results of an explanation cannot be read.
    #[error(transparent)]
    Explanation(#[from] gap::Error),
    /// The progress of a sweep cannot be read.
    #[error(transparent)]
    Progress(Box<sweep::Error>),
    /// A machine file or a sweep cannot be read.
    #[error(transparent)]
    Machine(#[from] input::Error),
    /// The curves beside them cannot be read.
    #[error("{}: {error}", path.display())]
    Curves {
        /// Their file.
        path: PathBuf,
        /// Why not.
        error: recordings::Error,
    },
    /// What a dataset shows cannot be computed, or a case not be simulated again.
    #[error(transparent)]
    Study(#[from] study::Error),
    /// A run that cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] signal::Error),
    /// A folder or a figure that cannot be changed.
    #[error("{}: {error}", path.display())]
    Unwritten {
        /// Its place.
        path: PathBuf,
        /// Why not.
        error: std::io::Error,
    },
    /// A page that cannot be written.
    #[error(transparent)]
    Write(recordings::Error),
}

impl Error {
    /// Whether the input is wrong; else the work failed.
    pub fn is_input(&self) -> bool {
        match self {
            Self::Dataset(error) => error.is_input(),
            Self::Progress(error) => error.is_input(),
            Self::Calibration(_) | Self::Explanation(_) | Self::Machine(_) => true,
            Self::Study(error) => error.is_input(),
            Self::Curves { .. } => true,
            _ => false,
        }
    }
}
