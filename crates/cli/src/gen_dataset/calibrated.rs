//! The calibration that a sweep asks for before its first case.

use crate::Failure;
use crate::calibrate::{finish, summary};
use ::calibrate::calibration::MACHINE;
use ::calibrate::results::{self, Known, RESULTS, not_excluded};
use ::calibrate::run_condition::CRANK_ANGLE_OFFSET;
use ::calibrate::{Calibrated, Prepared, Results, Settings};
use input::bundle::Bundle;
use input::{Error, paths};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Display;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use sweep::calibration::{Calibration, Estimate, Relations, Sweep};
use sweep::dataset::{CALIBRATION, Claim};
use sweep::sweep_file::{Amount, Uncertainty};
use sweep::{Existing, Plan};

/// Standard deviations on either side that bound 95 % of a normal distribution.
const QUANTILE: f64 = 1.959_964;

/// The plan of `sweep` with the machine calibrated into the locked folder of its dataset; a
/// calibration that is there and follows from the same recordings, machine and settings is used.
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
    let prepared = prepare(sweep, root)?;
    let mut claim = Claim::new(root, existing).map_err(super::failed)?;
    let folder = claim
        .calibration(prepared.is_done())
        .map_err(super::failed)?;
    let done = finish(prepared, cancel)?;
    tell(&done, &folder);
    if !done.results.complete {
        return Err(Failure::work(format!(
            "stopped during the calibration, before the first case; {} has the best so far, and \
             --resume goes on from there",
            folder.display()
        )));
    }
    Ok((claim, kept(sweep, &folder)?))
}

/// The plan with the calibration that the dataset's folder `root` holds; none where it holds none
/// or one of something else.
///
/// # Errors
/// Settings or recordings that cannot be used.
pub fn plan_if_kept(sweep: &Sweep, root: &Path) -> Result<Option<Plan>, Failure> {
    let is_done = prepare(sweep, root)?.is_done();
    let plan = is_done.then(|| kept(sweep, &root.join(CALIBRATION)));
    plan.transpose()
}

fn prepare(sweep: &Sweep, root: &Path) -> Result<Prepared, Failure> {
    let Some(calibrate) = sweep.calibrate() else {
        return Err(Failure::input("the sweep asks for no calibration"));
    };
    let machine = sweep.machine()?;
    let settings = Settings {
        calibration: &calibrate.settings,
        base: sweep.folder(),
        machine: machine.as_ref(),
        allow_outside: false,
        locate: &|error: Error| sweep.locate(error),
    };
    let folder = root.join(CALIBRATION);
    let existing = ::calibrate::Existing::Renew;
    ::calibrate::prepare(&settings, &folder, existing).map_err(Failure::input)
}

fn tell(done: &Calibrated, folder: &Path) {
    match done.reused {
        true => println!("calibrated before, and nothing has changed since:"),
        false => println!("calibrated into {}:", folder.display()),
    }
    summary::print(&done.results);
}

fn kept(sweep: &Sweep, folder: &Path) -> Result<Plan, Failure> {
    let mut calibration = read(folder)?;
    let asked = sweep.calibrate();
    if asked.is_some_and(|asked| asked.uncertainty == Uncertainty::Sampled) {
        sampled(folder, &calibration)?;
    }
    // A relation that the sweep states is what its author knows.
    if asked.is_some_and(|asked| asked.settings.relation.is_some()) {
        calibration.relations = Relations::default();
    }
    if let Some(own) = sweep.machine()? {
        let fitted = |path: &str| calibration.estimates.iter().any(|e| e.path == path);
        let mut machine = calibration.machine.clone();
        for path in conditions(sweep, &own)?.iter().filter(|path| !fitted(path)) {
            let value = paths::get(&own, path)?.cloned();
            paths::set(&mut machine, path, value.unwrap_or_else(|| "ideal".into()))?;
        }
        calibration.machine = machine;
    }
    Ok(sweep.calibrated(&calibration)?)
}

/// Checks that there are intervals to draw from.
///
/// # Errors
/// A calibration whose model is not adequate: its intervals would be too narrow, and none is stated.
fn sampled(folder: &Path, calibration: &Calibration) -> Result<(), Failure> {
    if calibration.is_adequate {
        return Ok(());
    }
    Err(Failure::work(format!(
        "calibrate.uncertainty: sampled draws from the intervals of the calibration, and {} states \
         none: its model is not adequate (model_is_adequate is false). Correct what the machine file \
         has wrong, or use uncertainty: ignored",
        folder.join(RESULTS).display()
    )))
}

/// The relations to the clearance that the recordings do not exclude: those that the comparison
/// leaves, weighted by Schwarz's criterion; where every run has the same clearances, all that have a
/// name, each as likely. Exponents that were fitted are estimates like others.
fn relations(results: &Results, machine: &Value) -> Result<Relations, Failure> {
    let mut joints = Vec::new();
    for (joint, stated) in results.relation.iter() {
        let own = paths::get(machine, &format!("{joint}.contact.relation"))?;
        if own.is_some_and(Value::is_object) {
            return Ok(Relations::default());
        }
        let clearance = stated.at_clearance_m.unwrap_or(stated.clearance_m);
        joints.push((joint.to_owned(), clearance));
    }
    Ok(Relations {
        weights: not_excluded(results.relations.as_ref()),
        joints,
    })
}

/// What the runs set in the machine file: speed, pressures, clearances. A sweep's own machine keeps
/// its own; a joint of which it says nothing is ideal.
fn conditions(sweep: &Sweep, machine: &Value) -> Result<BTreeSet<String>, Failure> {
    let mut conditions = BTreeSet::new();
    for folder in sweep.bundles() {
        for run in Bundle::read(&folder)?.runs {
            let settings = input::run_settings(&run.section, machine)?;
            conditions.extend(settings.into_iter().map(|(path, _)| path));
        }
    }
    Ok(conditions)
}

/// The calibration in `folder`.
///
/// # Errors
/// A file that is not what a calibration writes.
fn read(folder: &Path) -> Result<Calibration, Failure> {
    let damaged =
        |reason: &dyn Display| Failure::work(format!("{reason}; --overwrite calibrates again"));
    let path = folder.join(RESULTS);
    let results = Results::read(&path).map_err(|error| damaged(&error))?;
    let machine = input::machine_file::read(&folder.join(MACHINE))?;
    let machine = machine.to_tree().clone();
    let mut estimates = Vec::new();
    // The parameter of each estimate: one value may stand at several places.
    let mut names = Vec::new();
    // The zero of a crank angle and the conditions of a run are the recordings', not the machine's.
    let of_machine = |name: &str| name != CRANK_ANGLE_OFFSET && !name.starts_with("runs.");
    for (name, found) in results.parameters.iter() {
        // Told, but without an interval: neither drawn nor open.
        if !of_machine(name) || found.known() == Known::Fitted {
            continue;
        }
        for place in paths::matching(&machine, name)? {
            let estimate = estimate(&machine, &place, found);
            let incomplete = || damaged(&format!("{}: {name} is not complete", path.display()));
            estimates.push(estimate.ok_or_else(incomplete)?);
            names.push(name);
        }
    }
    let row = |a: &&str| names.iter().map(|b| results.correlation(a, b)).collect();
    Ok(Calibration {
        correlations: names.iter().map(row).collect(),
        relations: relations(&results, &machine)?,
        is_adequate: results.model_is_adequate,
        machine,
        estimates,
    })
}

/// What was `found` of the value at `place` of the calibrated machine; none where the machine has no number
/// there.
fn estimate(machine: &Value, place: &str, found: &results::Estimate) -> Option<Estimate> {
    let value = paths::get(machine, place).ok()??.clone();
    let dimension = Amount::of(&value)?.dimension;
    let width = match (found.known(), found.logarithmic) {
        (Known::Within([low, high]), true) => Some(scalar::elementary::ln(high / low)),
        (Known::Within([low, high]), false) => Some(high - low),
        (Known::Fitted | Known::Nothing, _) => None,
    };
    Some(Estimate {
        path: place.to_owned(),
        value,
        bounds: found.bounds.map(|si| Amount { si, dimension }.to_value()),
        logarithmic: found.logarithmic,
        deviation: width.map(|width| width / (2.0 * QUANTILE)),
    })
}
