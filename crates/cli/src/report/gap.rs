//! The page of an explanation, from what `crosshead explain-gap` has written.

use super::calibration::{machine_name, with_curves};
use crate::Failure;
use ::gap::folder::MACHINE;
use ::gap::results::{RESULTS, Results};
use ::report::calibration_page::{Misfit, Run};
use ::report::gap_page::GapPage;
use std::path::Path;

/// Whether an explanation has been written into `folder`.
pub(crate) fn is_at(folder: &Path) -> bool {
    folder.join(RESULTS).is_file()
}

/// What the page of the explanation in `folder` tells.
///
/// # Errors
/// A file that cannot be read, or is none that an explanation writes.
pub(crate) fn page(folder: &Path) -> Result<GapPage, Failure> {
    let results = Results::read(&folder.join(RESULTS)).map_err(Failure::input)?;
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
    Ok(GapPage {
        name: machine_name(machine.to_tree()),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        runs: with_curves(folder, runs.collect())?,
        results,
    })
}
