//! The HTML page of an estimation of wear: which joints are worn, how much, and how far that can be trusted.

mod folder;
mod page;

use crate::calibration_page::Run;
use calibrate::wear::Results;

/// The content of the page.
#[derive(Clone, Debug)]
pub struct WearPage {
    /// Name of the machine.
    pub name: String,
    /// Version of the program that makes the page.
    pub version: String,
    /// What the estimation found.
    pub results: Results,
    /// The runs with their curves.
    pub runs: Vec<Run>,
}
