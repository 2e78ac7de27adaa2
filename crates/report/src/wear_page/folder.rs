//! What an estimation has written, read back for its page.

use super::WearPage;
use crate::Error;
use crate::calibration_page::folder::{machine_name, with_curves};
use crate::calibration_page::{Misfit, Run};
use calibrate::results::MACHINE;
use calibrate::wear::{Results, WEAR};
use std::path::Path;

impl WearPage {
    /// The page of the estimation in `folder`.
    ///
    /// # Errors
    /// A file that cannot be read, or that no estimation writes.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let results = Results::read(&folder.join(WEAR))?;
        let machine = input::machine_file::read(&folder.join(MACHINE))?;
        let runs = results.runs.iter().map(|(id, run)| Run {
            id: id.to_owned(),
            held_out: false,
            misfit: Misfit {
                before: run.healthy,
                after: run.estimated,
            },
            channels: Vec::new(),
        });
        Ok(Self {
            name: machine_name(machine.to_tree()),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            runs: with_curves(folder, runs.collect())?,
            results,
        })
    }
}
