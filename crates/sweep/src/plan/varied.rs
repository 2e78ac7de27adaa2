//! An unknown that varies independently, at one or several places of the machine file.

use input::{Error, paths};
use serde_json::Value;

use super::sampler::Sampler;
use crate::sweep_file::Draw;

/// An unknown that varies independently.
#[derive(Clone, Debug)]
pub(super) struct Varied {
    /// Its path as the sweep file has it.
    pub(super) written: String,
    /// The places that get the value that is drawn: several where the path has a `*`.
    pub(super) places: Vec<String>,
    pub(super) sampler: Sampler,
}

impl Varied {
    /// What the sweep file says under `vary`; `machine` is the machine file's tree.
    pub(super) fn new(path: &str, draw: &Draw, machine: &Value) -> Result<Self, Error> {
        let at_path = |e: Error| Error::new(path, e.problem().clone());
        let places = match path.split('.').any(|part| part == "*") {
            false => vec![path.to_owned()],
            true => paths::matching(machine, path).map_err(at_path)?,
        };
        if path == "sample_rate" {
            let expected = "one rate for all cases, as run.sample_rate, e.g. 10 kHz";
            return Err(Error::unexpected(path, path, expected));
        }
        let Some(first) = places.first() else {
            let expected = "a path that stands for a value of the machine file";
            return Err(Error::unexpected(
                path,
                "nothing in the machine file",
                expected,
            ));
        };
        let given = paths::get(machine, first).map_err(at_path)?;
        Ok(Self {
            written: path.to_owned(),
            sampler: Sampler::new(draw, given).map_err(|e| e.under(path))?,
            places,
        })
    }
}
