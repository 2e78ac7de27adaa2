//! Wear of machines whose recordings the model itself has made, without noise.

use crate::own_recordings::{machine, problem, scattering};
use calibrate::optimiser::Progress;
use calibrate::run_condition::CRANK_ANGLE_OFFSET;
use calibrate::wear::{Contact, Interval, Results, Verdict, estimate};
use calibrate::{Parameter, Problem, Stage, Watcher};
use input::paths;
use serde_json::{Value, json};
use std::ops::ControlFlow;

const BIG: &str = "joints.big_end";
const SMALL: &str = "joints.small_end";
/// Standard deviation of every line, m/s²: about 0.2 % of the acceleration.
const NOISE: f64 = 0.4;
/// Orders that are compared.
const ORDERS: usize = 100;

/// Follows nothing, and stops after so many steps.
struct Steps(usize);

impl Watcher for Steps {
    fn begins(&mut self, _: Stage, _: u64) {}
    fn progress(&mut self, _: &Progress) -> ControlFlow<()> {
        self.0 = self.0.saturating_sub(1);
        match self.0 {
            0 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }
    fn ends(&mut self) {}
}

/// The single-stage machine with these clearances of big end and small end, and contacts that do not follow the clearance. It
/// has no guide and no main bearing that may be worn.
fn file(clearances: [&str; 2]) -> Value {
    let mut tree = machine(clearances);
    for (joint, key, value) in [BIG, SMALL].into_iter().flat_map(|joint| {
        [("relation", "constant"), ("at_clearance", "0.03 mm")]
            .map(|(key, value)| (joint, key, value))
    }) {
        paths::set(&mut tree, &format!("{joint}.contact.{key}"), json!(value)).unwrap();
    }
    for joint in ["guide", "main"] {
        tree["joints"][joint] = json!("ideal");
    }
    tree
}

/// The healthy machine `file` beside the recordings of the machine `worn`.
fn recorded(file: Value, worn: Value) -> Problem {
    let mut recorded = problem(worn, &[], &[500.0], ORDERS, NOISE.powi(2));
    let offset = Parameter::named(&file, &[], CRANK_ANGLE_OFFSET, None);
    recorded.parameters = vec![offset.unwrap()];
    recorded.tree = file;
    recorded
}

fn estimated(problem: &Problem) -> Results {
    let start = vec![0.0; problem.parameters.len()];
    estimate(problem, &start, 1.5, &mut Steps(usize::MAX)).unwrap()
}

fn assert_holds(results: &Results, joint: &str, verdict: Verdict, truth: f64) {
    let found = results.joints.get(joint).unwrap();
    assert_eq!(found.verdict, verdict, "{found:?}");
    let clearance = found.clearance_m.unwrap();
    assert!((clearance / truth - 1.0).abs() < 2e-3, "{found:?}");
    let (low, high) = (found.low_m.unwrap(), found.high_m.unwrap());
    assert!((low..=high).contains(&truth), "{found:?}");
    assert_eq!(found.diametral_clearance_m, Some(2.0 * clearance));
}

#[test]
fn of_two_joints_the_worn_one_is_found_with_its_clearance() {
    let worn = file(["0.12 mm", "0.028 mm"]);
    let results = estimated(&recorded(file(["0.03 mm", "0.03 mm"]), worn));
    assert_holds(&results, BIG, Verdict::Worn, 1.2e-4);
    assert_holds(&results, SMALL, Verdict::Healthy, 2.8e-5);
    assert_eq!(results.worn(), [BIG]);
    assert_eq!(results.interval, Interval::Noise);
    assert_eq!(results.contact, Contact::MachineFile);
    assert!(results.complete && results.model_is_adequate);
    assert!(results.fit.healthy > 10.0 && results.fit.estimated < 1.0);
    let text = serde_json::to_string(&results).unwrap();
    assert_eq!(serde_json::from_str::<Results>(&text).unwrap(), results);
}

#[test]
fn a_joint_that_is_ideal_in_the_file_becomes_clear_where_the_recordings_need_it() {
    let healthy = file(["0.03 mm", "ideal"]);
    let results = estimated(&recorded(healthy.clone(), file(["0.03 mm", "0.1 mm"])));
    assert_holds(&results, SMALL, Verdict::Worn, 1e-4);
    assert_holds(&results, BIG, Verdict::Healthy, 3e-5);
    assert_eq!(results.joints.get(SMALL).unwrap().healthy_m, None);

    let results = estimated(&recorded(healthy.clone(), healthy));
    let small = results.joints.get(SMALL).unwrap();
    assert_eq!((small.verdict, small.clearance_m), (Verdict::Healthy, None));
    assert!(results.worn().is_empty());
}

#[test]
#[ignore = "minutes: tests/nightly/run calibrations"]
fn clearances_are_found_where_the_motion_does_not_repeat_itself() {
    // With a tenth of the damping the motion is chaotic (data/machines/single-stage.yaml).
    let light = |clearances| {
        let mut tree = file(clearances);
        for joint in [BIG, SMALL] {
            let path = format!("{joint}.contact.damping");
            paths::set(&mut tree, &path, json!("2e3 N s/m")).unwrap();
        }
        tree
    };
    let mut recorded = scattering(light(["0.3 mm", "0.3 mm"]));
    recorded.tree = light(["0.294 mm", "0.306 mm"]);
    let results = estimated(&recorded);
    for joint in [BIG, SMALL] {
        let found = results.joints.get(joint).unwrap();
        assert_eq!(found.verdict, Verdict::Worn, "{found:?}");
        let interval = found.low_m.unwrap()..=found.high_m.unwrap();
        assert!(interval.contains(&3e-4), "{found:?}");
        assert!(*interval.end() < 1.2 * interval.start(), "{found:?}");
    }
    assert_eq!(results.interval, Interval::Scatter);
    assert!(results.complete && results.model_is_adequate);
}

#[test]
fn an_estimation_that_is_stopped_says_so_and_has_no_interval() {
    let recorded = recorded(file(["0.03 mm", "ideal"]), file(["0.12 mm", "ideal"]));
    let results = estimate(&recorded, &[0.0], 1.5, &mut Steps(4)).unwrap();
    assert!(!results.complete);
    assert_eq!(results.interval, Interval::None);
    let words = results.to_string();
    assert!(words.starts_with("stopped; the best so far:"), "{words}");
    assert!(!words.contains("does not explain"), "{words}");
    // Of the small end, ideal in the best machine so far, nothing is known either.
    for (_, joint) in results.joints.iter() {
        assert_eq!((joint.verdict, joint.low_m), (Verdict::Unclear, None));
    }
}
