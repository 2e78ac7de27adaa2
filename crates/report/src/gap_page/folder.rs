//! What an explanation has written, read back for its page.

use super::GapPage;
use crate::Error;
use crate::calibration_page::folder::{machine_name, with_curves};
use crate::calibration_page::{Misfit, Run};
use gap::folder::MACHINE;
use gap::results::{RESULTS, Results};
use std::path::Path;

impl GapPage {
    /// The page of the explanation in `folder`.
    ///
    /// # Errors
    /// A file that cannot be read, or that no explanation writes.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let results = Results::read(&folder.join(RESULTS))?;
        let machine = input::machine_file::read(&folder.join(MACHINE))?;
        let runs = results.runs.iter().map(|(id, run)| Run {
            id: id.to_owned(),
            held_out: run.held_out,
            misfit: Misfit {
                before: run.before,
                after: run.after,
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
