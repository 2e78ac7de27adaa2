//! The calibration that a sweep asks for before its first case.

use crate::Failure;
use crate::calibrate::finish;
use ::calibrate::Calibrated;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use sweep::calibration::Sweep;
use sweep::dataset::{CALIBRATION, Claim};
use sweep::{Existing, Plan};

/// The plan of `sweep` with the machine calibrated into the locked folder of its dataset. An
/// existing calibration is used if it has the same recordings, machine and settings.
///
/// # Errors
/// Settings or recordings that cannot be used (nothing was written then), or a search that failed
/// or was stopped by `cancel`.
pub fn plan(
    sweep: &Sweep,
    root: &Path,
    existing: Existing,
    cancel: &AtomicBool,
) -> Result<(Claim, Plan), Failure> {
    let prepared = sweep.prepared(root).map_err(Failure::input)?;
    let mut claim = Claim::new(root, existing)?;
    let folder = claim.calibration(prepared.is_done())?;
    let done = finish(prepared, cancel)?;
    print(&done, &folder);
    if !done.results.complete {
        return Err(Failure::interrupted(format!(
            "stopped during the calibration, before the first case; {} has the best so far, and \
             --resume continues from there",
            folder.display()
        )));
    }
    Ok((claim, sweep.kept(&folder)?))
}

/// The plan with the calibration that the dataset's folder `root` holds; none where it holds none
/// or one of something else.
///
/// # Errors
/// Settings or recordings that cannot be used.
pub fn plan_if_kept(sweep: &Sweep, root: &Path) -> Result<Option<Plan>, Failure> {
    let prepared = sweep.prepared(root).map_err(Failure::input)?;
    let is_done = prepared.is_done();
    let plan = is_done.then(|| sweep.kept(&root.join(CALIBRATION)));
    Ok(plan.transpose()?)
}

fn print(done: &Calibrated, folder: &Path) {
    match done.reused {
        true => println!("calibrated before, and nothing has changed since:"),
        false => println!("calibrated into {}:", folder.display()),
    }
    print!("{}", done.results);
}
