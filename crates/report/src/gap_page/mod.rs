//! The HTML page of an explanation: where model and recordings disagreed, which effect was missing,
//! and how far the gap has shrunk.

mod figures;
mod folder;
mod page;
mod parts;
mod units;

use crate::calibration_page::Run;
use gap::Results;

/// The content of the page.
#[derive(Clone, Debug)]
pub struct GapPage {
    /// Name of the machine.
    pub name: String,
    /// Version of the program that makes the page.
    pub version: String,
    /// What the explanation found.
    pub results: Results,
    /// The runs with their curves.
    pub runs: Vec<Run>,
}
