//! The calibration that a sweep asks for before its first case.

use crate::Failure;
use crate::calibrate::{self, Calibrated, Prepared, Settings, output};
use ::calibrate::run_condition::CRANK_ANGLE_OFFSET;
use input::bundle::Bundle;
use input::{Error, paths};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use sweep::calibration::{Calibration, Estimate, Sweep};
use sweep::dataset::{CALIBRATION, Claim};
use sweep::sweep_file::{Amount, Calibrate, Uncertainty};
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
    let done = prepared.finish(cancel)?;
    tell(&done, &folder);
    if done.results["complete"] == false {
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
        locate: &|error: Error| sweep.locate(error),
    };
    let folder = root.join(CALIBRATION);
    calibrate::prepare(&settings, &folder, calibrate::Existing::Renew)
}

fn tell(done: &Calibrated, folder: &Path) {
    match done.reused {
        true => println!("calibrated before, and nothing has changed since:"),
        false => println!("calibrated into {}:", folder.display()),
    }
    output::summary(&done.results);
}

fn kept(sweep: &Sweep, folder: &Path) -> Result<Plan, Failure> {
    let results = results(folder)?;
    let sampled = |calibrate: &Calibrate| calibrate.uncertainty == Uncertainty::Sampled;
    if results["model_is_adequate"] == false && sweep.calibrate().is_some_and(sampled) {
        return Err(Failure::work(format!(
            "{}: the calibrated model does not explain the recordings, so that `uncertainty: sampled` has no \
             interval to draw from; `uncertainty: ignored` takes the values as they are",
            folder.join(output::RESULTS).display()
        )));
    }
    let mut calibration = read(folder, &results)?;
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

fn damaged(folder: &Path, reason: &str) -> Failure {
    let path = folder.join(output::RESULTS);
    let path = path.display();
    Failure::work(format!("{path}: {reason}; --overwrite calibrates again"))
}

/// The content of the `calibration.json` in `folder`.
fn results(folder: &Path) -> Result<Value, Failure> {
    let damaged = |reason: String| damaged(folder, &reason);
    let text = std::fs::read_to_string(folder.join(output::RESULTS));
    let text = text.map_err(|error| damaged(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| damaged(error.to_string()))
}

/// The calibration in `folder`, of which these are the results.
///
/// # Errors
/// A file that is not what a calibration writes.
fn read(folder: &Path, results: &Value) -> Result<Calibration, Failure> {
    let machine = input::machine_file::read(&folder.join(output::MACHINE))?;
    let machine = machine.to_tree().clone();
    let parameters = results["parameters"].as_object();
    let mut estimates = Vec::new();
    // The parameter of each estimate: one value may stand at several places.
    let mut names = Vec::new();
    // The zero of a crank angle and the conditions of a run are the recordings', not the machine's.
    let of_machine = |name: &&String| *name != CRANK_ANGLE_OFFSET && !name.starts_with("runs.");
    for (name, found) in parameters
        .into_iter()
        .flatten()
        .filter(|(name, _)| of_machine(name))
    {
        for place in paths::matching(&machine, name)? {
            let estimate = estimate(&machine, &place, found);
            let incomplete = || damaged(folder, &format!("{name} is not complete"));
            let estimate = estimate.ok_or_else(incomplete)?;
            estimates.push(estimate);
            names.push(name.as_str());
        }
    }
    let correlation = |a: &str, b: &str| match a == b {
        true => 1.0,
        false => results["correlations"][a][b].as_f64().unwrap_or(0.0),
    };
    let row = |a: &&str| names.iter().map(|b| correlation(a, b)).collect();
    Ok(Calibration {
        correlations: names.iter().map(row).collect(),
        machine,
        estimates,
    })
}

/// What `found` says of the value at `place` of the calibrated machine.
fn estimate(machine: &Value, place: &str, found: &Value) -> Option<Estimate> {
    let value = paths::get(machine, place).ok()??.clone();
    let dimension = Amount::of(&value)?.dimension;
    let amount = |si: &Value| {
        let si = si.as_f64()?;
        Some(Amount { si, dimension }.to_value())
    };
    let logarithmic = found["logarithmic"].as_bool()?;
    // One that is not identifiable has no interval, nor has any in a model that is wrong.
    let interval = match found["identifiable"].as_bool()? && !found["low"].is_null() {
        true => Some([found["low"].as_f64()?, found["high"].as_f64()?]),
        false => None,
    };
    let width = |[low, high]: [f64; 2]| match logarithmic {
        true => scalar::elementary::ln(high / low),
        false => high - low,
    };
    Some(Estimate {
        path: place.to_owned(),
        value,
        bounds: [amount(&found["bounds"][0])?, amount(&found["bounds"][1])?],
        logarithmic,
        deviation: interval.map(|interval| width(interval) / (2.0 * QUANTILE)),
    })
}
