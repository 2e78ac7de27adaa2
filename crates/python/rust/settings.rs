//! Settings of a calibration, as the keys of a calibration file.

use cli::Failure;
use input::calibration::Calibration;
use input::yaml::Document;
use serde_json::Value;

/// The settings of this JSON object.
///
/// # Errors
/// A key or a value that a calibration file does not have.
pub fn settings(text: &str) -> Result<Calibration, Failure> {
    let tree: Value = serde_json::from_str(text).map_err(Failure::input)?;
    Ok(Calibration::from_document(&Document::from_tree(tree))?)
}
