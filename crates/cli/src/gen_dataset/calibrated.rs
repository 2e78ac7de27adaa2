//! The calibration that a sweep asks for before its first case.

use crate::Failure;
use crate::bundle::AllowOutside;
use crate::calibrate::{self, Calibrated, Prepared, Settings, output, relation};
use ::calibrate::run_condition::CRANK_ANGLE_OFFSET;
use input::bundle::Bundle;
use input::{Error, paths};
use serde_json::Value;
use std::collections::BTreeSet;
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
    let done = prepared.finish(cancel)?;
    tell(&done, &folder)?;
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
        outside: AllowOutside::default(),
        locate: &|error: Error| sweep.locate(error),
    };
    let folder = root.join(CALIBRATION);
    calibrate::prepare(&settings, &folder, calibrate::Existing::Renew)
}

fn tell(done: &Calibrated, folder: &Path) -> Result<(), Failure> {
    match done.reused {
        true => println!("calibrated before, and nothing has changed since:"),
        false => println!("calibrated into {}:", folder.display()),
    }
    output::summary(&done.results)
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
        folder.join(output::RESULTS).display()
    )))
}

/// The relations to the clearance that the recordings do not exclude: those that the comparison
/// leaves, weighted by Schwarz's criterion; where every run has the same clearances, all that have a
/// name, each as likely. Exponents that were fitted are estimates like others.
fn relations(results: &Value, machine: &Value) -> Result<Relations, Failure> {
    let mut joints = Vec::new();
    for (joint, stated) in results["relation"].as_object().into_iter().flatten() {
        let own = paths::get(machine, &format!("{joint}.contact.relation"))?;
        if own.is_some_and(Value::is_object) {
            return Ok(Relations::default());
        }
        let at = stated["at_clearance_m"].as_f64();
        let clearance = at.or_else(|| stated["clearance_m"].as_f64());
        joints.extend(clearance.map(|clearance| (joint.clone(), clearance)));
    }
    Ok(Relations {
        weights: relation::not_excluded(&results["relations"]),
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

fn damaged(folder: &Path, reason: &str) -> Failure {
    let path = folder.join(output::RESULTS);
    let path = path.display();
    Failure::work(format!("{path}: {reason}; --overwrite calibrates again"))
}

/// The content of the `calibration.json` in `folder`.
fn results(folder: &Path) -> Result<Value, Failure> {
    let damaged = |reason: String| damaged(folder, &reason);
    let text = files::read_text(&folder.join(output::RESULTS), files::LONGEST_TEXT);
    let text = text.map_err(|error| damaged(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| damaged(error.to_string()))
}

/// The calibration in `folder`.
///
/// # Errors
/// A file that is not what a calibration writes.
fn read(folder: &Path) -> Result<Calibration, Failure> {
    let results = results(folder)?;
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
        // Told, but without an interval: neither drawn nor open.
        .filter(|(_, found)| found["identifiable"] == false || found["low"].is_number())
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
        relations: relations(&results, &machine)?,
        is_adequate: results["model_is_adequate"] != false,
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
