//! The runs that a machine is predicted in, at other clearances than those it was fitted at.

use crate::observation::Observation;
use crate::relation::ClearJoint;
use std::collections::BTreeMap;

/// How many times its normal clearance a worn joint is predicted at.
const WORN: f64 = 3.0;

/// A run that is predicted.
pub(crate) struct Case {
    /// Its conditions, and what was recorded.
    pub run: Observation,
    /// The clearances that are not those of the fitted runs, by the joint's path, m.
    pub clearances: BTreeMap<String, f64>,
    /// Whether the recording was made at these clearances.
    pub recorded: bool,
}

/// The runs that are predicted: those held out whose clearances no fitted run has, and each fitted
/// run without wear, with each joint worn in turn.
pub(super) fn cases(
    runs: &[(&Observation, &Vec<Option<f64>>)],
    joints: &[ClearJoint],
    held_out: impl Fn(&Observation) -> bool,
    fixed: impl Fn(&ClearJoint) -> bool,
    of_fitted: &[Vec<Option<f64>>],
) -> Vec<Case> {
    let mut cases = Vec::new();
    for (run, state) in runs {
        let clear = joints.iter().zip(*state);
        let clear = clear.filter_map(|(joint, c)| c.map(|c| (joint, c)));
        if !held_out(run) {
            if clear.clone().all(|(joint, c)| c == joint.clearance) {
                let wearing = clear.filter(|(joint, _)| !fixed(joint));
                cases.extend(wearing.map(|(joint, _)| worn(run, joint)));
            }
        } else if !of_fitted.contains(state) {
            cases.push(Case {
                run: (*run).clone(),
                clearances: clear.map(|(j, c)| (j.path.clone(), c)).collect(),
                recorded: true,
            });
        }
    }
    cases
}

/// A run with one joint worn.
fn worn(run: &Observation, joint: &ClearJoint) -> Case {
    let clearance = WORN * joint.clearance;
    let mut run = run.clone();
    let setting = (
        joint.path.clone() + ".clearance",
        format!("{clearance} m").into(),
    );
    run.settings.push(setting);
    Case {
        run,
        clearances: BTreeMap::from([(joint.path.clone(), clearance)]),
        recorded: false,
    }
}
