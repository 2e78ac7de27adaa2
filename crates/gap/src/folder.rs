//! An explanation from a bundle to a folder: `gap.json`, `machine.yaml`, `simulated/`, `baseline/` and what
//! pictures are drawn from.

use crate::error::Error;
use crate::explain::{Explanation, Stage, explain};
use crate::fitter::Watch;
use crate::fitter::effort::Effort;
use crate::fitter::journal::Journal;
use crate::mains_hum::remove_hum;
use crate::recorded::Recorded;
use crate::results::notes::leave_open;
use crate::results::{RESULTS, Results};
use calibrate::bundle_replay::BundleReplay;
use calibrate::observation::Observation;
use calibrate::pressure_gap::pressure_gaps_of;
use calibrate::sensors::{Fitted, Sensors};
use calibrate::{Settings, compare_models, pictures, simulated_means, task};
use input::MachineFile;
use input::bundle::Bundle;
use input::calibration::Calibration;
use input::effects::Entry;
use recordings::WholeFile;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the explained machine.
pub const MACHINE: &str = "machine.yaml";
/// Name of the file of finished work, with which an explanation that was stopped goes on.
const FINISHED: &str = "finished.jsonl";
/// Most evaluations of the model in one descent.
const EVALUATIONS: u64 = 120;

/// What is to be explained.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    /// The recordings and what is calibrated.
    pub calibration: &'a Calibration,
    /// The folder from which its paths start.
    pub base: &'a Path,
    /// Whether the bundle may name recordings outside of its folder.
    pub allow_outside: bool,
    /// Gives an error in the settings its line.
    pub locate: &'a dyn Fn(input::Error) -> input::Error,
}

/// Explains the gap between a machine and the recordings of one bundle into the folder `out`, and gives
/// back what `gap.json` says. Where it was stopped, it goes on from what was finished.
///
/// # Errors
/// [`Error::Input`] where the bundle, the machine or the settings are wrong; [`Error::Stopped`]; a machine
/// that cannot be simulated, or a file that cannot be written.
pub fn into_folder(
    asked: &Asked,
    out: &Path,
    report: &(dyn Fn(&Stage) + Sync),
    watch: Watch,
) -> Result<Results, Error> {
    let calibration = asked.calibration;
    let [bundle] = calibration.bundles() else {
        let count = calibration.bundles().len();
        let reason = format!("explain-gap takes one bundle, not {count}");
        return Err(Error::Input(calibrate::Error::Refused(reason)));
    };
    let mut bundle = Bundle::read(&asked.base.join(bundle)).map_err(|e| Error::Input(e.into()))?;
    bundle.allow_outside = asked.allow_outside;
    let mut task = task(&Settings {
        calibration,
        base: asked.base,
        machine: None,
        allow_outside: asked.allow_outside,
        clearances_unknown: false,
        locate: asked.locate,
    })
    .map_err(Error::Input)?;
    let held_out = task.settings.held_out.clone();
    std::fs::create_dir_all(out).map_err(|error| calibrate::Error::file(out, error))?;
    let finished = out.join(FINISHED);
    let journal = Journal::open(&finished)?;
    let effort = Effort::new(&task.problem, held_out, EVALUATIONS, journal)?;
    let hum = remove_hum(&mut task.problem, &mut task.runs)?;
    let start = task.settings.start.as_deref();
    let mut explanation = explain(&task.problem, start, &hum, &effort, report, watch)?;
    let [before, after] = [&explanation.baseline, &explanation.explained];
    let baseline = before.problem.fitted(&before.x)?;
    // What was taken off the recordings is in no simulation that is compared with them.
    let explained = machine(&explanation, |effect| !effect.proposal.is_separate())?;
    for (folder, tree, model) in [
        ("simulated", explained, after),
        ("baseline", baseline, before),
    ] {
        let of_run = |run: &Observation| {
            let conditions = model.problem.conditions(&run.id, &model.x)?;
            Ok((run.id.clone(), conditions))
        };
        let of_runs = model.problem.runs.iter().map(of_run);
        let of_runs: BTreeMap<String, Vec<(String, Value)>> =
            of_runs.collect::<Result<_, Error>>()?;
        let conditions = |run: &str| of_runs.get(run).cloned().unwrap_or_default();
        let (left_out, folder) = (&calibration.leave_out, out.join(folder));
        let replay = BundleReplay::prepare(&bundle, tree, conditions, left_out, &folder);
        replay.map_err(refused)?.write()?;
    }
    let models = [before, after].map(|model| (&model.problem, &model.x[..]));
    pictures::write(out, &compare_models(models, &task.runs)?)?;
    let steps = explanation.steps.iter().map(|step| {
        let means = simulated_means(&step.model.problem, &step.model.x)?;
        Ok((step.label.clone(), means))
    });
    pictures::write_steps(out, &steps.collect::<Result<Vec<_>, Error>>()?)?;
    let gas = pressure_gaps_of(models, &task.runs)?;
    let sensors = Sensors::from_recordings(&Fitted {
        problem: &after.problem,
        x: &after.x,
        misfits: after.by_run.clone(),
        runs: &task.runs,
        encoded: &task.encoded,
    })?;
    let mut tree = machine(&explanation, |_| true)?;
    sensors.write(&mut tree)?;
    WholeFile::write(
        &out.join(MACHINE),
        &MachineFile::from_tree(&tree)?.to_yaml()?,
    )?;
    let recorded = Recorded {
        gas: &gas,
        shut_valves: &task.shut_valves,
        noise: sensors.by_column,
    };
    leave_open(&mut explanation, &recorded);
    let results = Results::from_explanation(&explanation, &effort, &recorded)?;
    // Last, as what makes the folder whole.
    let text = serde_json::to_string_pretty(&results)?;
    WholeFile::write(&out.join(RESULTS), &text)?;
    std::fs::remove_file(&finished).map_err(|error| calibrate::Error::file(&finished, error))?;
    Ok(results)
}

/// Why a replay cannot begin: its input is wrong, unless the simulation fails.
fn refused(error: calibrate::Error) -> Error {
    match error {
        calibrate::Error::Simulation { .. } => error.into(),
        error => Error::Input(error),
    }
}

/// The explained machine file, with those findings about the measuring chain whose effect `keep` names.
fn machine(explanation: &Explanation, keep: impl Fn(&Entry) -> bool) -> Result<Value, Error> {
    let model = &explanation.explained;
    let mut tree = model.problem.fitted(&model.x)?;
    let chain = explanation.chain.iter().map(|found| &found.effect);
    for found in chain.filter(|found| keep(found.candidate.entry)) {
        let place = found.candidate.place.iter();
        let place: Vec<(&str, &str)> = place.map(|(key, word)| (*key, word.as_str())).collect();
        let effects = tree["effects"].take();
        let mut effects = effects.as_array().cloned().unwrap_or_default();
        effects.push(found.candidate.entry.item(&place, &found.values));
        tree["effects"] = effects.into();
    }
    Ok(tree)
}
