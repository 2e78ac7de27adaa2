//! The gas by itself: pressures hardly depend on the joints.

use crate::error::Error;
use crate::recorded::{is_of_pressures, is_pressure};
use calibrate::Problem;
use calibrate::likelihood::Likelihood;
use serde_json::Value;

/// The same problem with the pressures alone, in a machine of ideal joints, which is simulated much
/// faster. None without recorded pressures. The effect of clear joints on the pressures is subtracted from the
/// recorded ones, as the nominal machine has it.
///
/// # Errors
/// A machine that cannot be simulated.
pub(crate) fn pressures(problem: &Problem) -> Result<Option<Problem>, Error> {
    let mut clear = problem.clone();
    clear
        .parameters
        .retain(|p| p.is_crank_angle_offset() || p.path.contains("cylinder."));
    for run in &mut clear.runs {
        run.channels.retain(is_pressure);
    }
    clear.runs.retain(|run| !run.channels.is_empty());
    if clear.runs.is_empty() {
        return Ok(None);
    }
    let mut ideal = clear.clone();
    idealise(&mut ideal.tree);
    let settings = ideal.runs.iter_mut().flat_map(|run| &mut run.settings);
    for (_, value) in settings.filter(|(path, _)| path.ends_with(".clearance")) {
        *value = "ideal".into();
    }
    let nominal = vec![0.0; clear.parameters.len()];
    let [with, without] = [&clear, &ideal].map(|p| Likelihood::new(p).predictions(&nominal));
    for (run, (with, without)) in ideal.runs.iter_mut().zip(with?.iter().zip(&without?)) {
        let lines = with.lines.iter().zip(&without.lines);
        for (channel, (with, without)) in run.channels.iter_mut().zip(lines) {
            let both = with.amplitude.iter().zip(&without.amplitude);
            for (recorded, (with, without)) in channel.lines.amplitude.iter_mut().zip(both) {
                *recorded -= with - without;
            }
        }
    }
    Ok(Some(ideal))
}

/// Whether a problem has more than its pressures and what they show.
pub(crate) fn has_joints(problem: &Problem) -> bool {
    let of_gas =
        |p: &calibrate::Parameter| p.is_crank_angle_offset() || p.path.contains("cylinder.");
    !is_of_pressures(problem) || !problem.parameters.iter().all(of_gas)
}

/// Makes every joint of a machine file ideal.
fn idealise(tree: &mut Value) {
    match tree {
        Value::Object(section) => {
            for (key, value) in section {
                if key == "joints" {
                    for joint in value.as_object_mut().into_iter().flatten() {
                        if let Some(clearance) = joint.1.get_mut("clearance") {
                            *clearance = "ideal".into();
                        }
                    }
                } else {
                    idealise(value);
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(idealise),
        _ => {}
    }
}
