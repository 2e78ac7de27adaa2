//! What the recordings of a folder say of themselves, so that it need not be typed.

use super::{MeasuredChannel, MeasuredFile, Options};
use crate::formats::FORMATS;
use crate::{Column, Error, Value};
use std::path::Path;

/// The heading of a file of recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading {
    /// Name of the file in its folder.
    pub file: String,
    /// Its channels, without a column of time.
    pub channels: Vec<MeasuredChannel>,
    /// Samples per second, if the file says so.
    pub sample_rate_hz: Option<f64>,
    /// Speed of the crank, rpm, if the file says so.
    pub speed_rpm: Option<f64>,
}

/// The headings of the recordings in `folder`, in the order of their names: of the files that end as those of a format do.
/// For each that cannot be read, why.
pub fn headings(folder: &Path) -> Vec<Result<Heading, Error>> {
    let folder = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|name| is_recording(name)).collect();
    names.sort();
    names
        .into_iter()
        .map(|file| heading(folder, file))
        .collect()
}

/// Whether a file of this name is one of recordings.
fn is_recording(name: &str) -> bool {
    let ending = Path::new(name).extension().unwrap_or_default();
    let ending = ending.to_string_lossy().to_ascii_lowercase();
    FORMATS
        .iter()
        .any(|format| format.endings.contains(&&*ending))
}

fn heading(folder: &Path, file: String) -> Result<Heading, Error> {
    let mut opened = MeasuredFile::open(&folder.join(&file), &Options::default())?;
    let first = opened.next().transpose()?;
    let is_speed = |label: &Column| label.name == "speed_rpm";
    let speed = opened.labels.iter().position(is_speed);
    let label = |at: usize| first.as_ref()?.labels.get(at);
    let speed_rpm = match speed.and_then(label) {
        Some(Value::Real(speed)) => Some(*speed),
        _ => None,
    };
    Ok(Heading {
        file,
        channels: opened.channels,
        sample_rate_hz: first.and_then(|recording| recording.sample_rate_hz),
        speed_rpm,
    })
}
