//! What bad sweep files get: one message with file, line, key, what was found and what belongs.

use input::yaml::Document;
use std::path::Path;
use sweep::{Error, Plan};

const HEAD: &str = "name: test
machine: single-stage.yaml
run: {revolutions: 4, transient: 2}
";

fn plan(text: &str) -> Result<Plan, input::Error> {
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    Plan::new(&Document::parse(text, "sweep.yaml")?, &machines)
}

/// How a file goes on after its first three lines, and the message that this gets.
const MISTAKES: &[(&str, &str)] = &[
    (
        "caes: []",
        "sweep.yaml:4:1: caes: unknown key; expected one of name, study, licence, machine, calibrate, calibrated, seed, run, repeats, windows, cases, vary, vary_together, bifurcations, splits, format, shard_size; did you mean 'cases'?\nsweep.yaml:4:7: caes: found no case at all, expected at least one",
    ),
    ("", "sweep.yaml:1:1: cases: missing; expected a list"),
    (
        "licence: cc-by4.0\ncases: [{grid: {speed: 500 rpm}}]",
        "sweep.yaml:4:10: licence: found 'cc-by4.0', expected one of CC0-1.0, CC-BY-4.0, CC-BY-SA-4.0, CC-BY-NC-4.0, CC-BY-NC-SA-4.0, CC-BY-ND-4.0, CC-BY-NC-ND-4.0, CDLA-Permissive-2.0, CDLA-Sharing-1.0, ODbL-1.0, ODC-By-1.0, PDDL-1.0, MIT, Apache-2.0; did you mean 'CC-BY-4.0'?",
    ),
    (
        "cases: []",
        "sweep.yaml:4:8: cases: found no case at all, expected at least one",
    ),
    (
        "cases:\n  - grid: {speed: []}",
        "sweep.yaml:5:3: cases: found no case at all, expected at least one",
    ),
    (
        "cases:\n  - grid: {joints: [], clearance: 0.1 mm}",
        "sweep.yaml:5:3: cases: found no case at all, expected at least one",
    ),
    (
        "cases:\n  - grid: {joints: [[big_edn]], clearance: 0.1 mm}",
        "sweep.yaml:5:22: cases.0.grid.joints.0.0: found 'big_edn', expected one of main, big_end, small_end, guide; did you mean 'big_end'?",
    ),
    (
        "cases:\n  - grid: {joints: [big_end], clearance: 0.1 mm}",
        "sweep.yaml:5:21: cases.0.grid.joints.0: found \"big_end\", expected a list of joints, e.g. [big_end]",
    ),
    (
        "cases:\n  - grid: {joints: [[big_end]]}",
        "sweep.yaml:5:20: cases.0.grid.joints: found joints without clearance, expected an axis clearance, or joints.big_end.clearance, beside it",
    ),
    (
        "cases:\n  - grid: {clearance: 0.1 mm}",
        "sweep.yaml:5:23: cases.0.grid.clearance: found a clearance without joints, expected an axis joints beside it, e.g. 'joints: [[], [big_end]]'",
    ),
    (
        "cases:\n  - grid:\n      joints: [[big_end]]\n      clearance: [0.1 mm, 80 mm]",
        "sweep.yaml:7:27: cases.0.grid.clearance.1: found '80 mm', expected a radial clearance below journal_radius, 0.05 m, or a diametral one below 0.1 m",
    ),
    (
        "cases:\n  - grid:\n      joints: [[], [big_end]]\n      clearance: [0.1 mm, 0.2]",
        "sweep.yaml:7:27: cases.0.grid.clearance.1: found 0.2, expected a length of at least 0 with its unit, e.g. '0.1 mm', or 'ideal'",
    ),
    (
        "cases:\n  - grid:\n      speed: [500 rpm, 8 kg]",
        "sweep.yaml:6:24: cases.0.grid.speed.1: found '8 kg' (a mass), expected a rotational speed greater than 0 with its unit, e.g. '500 rpm'",
    ),
    (
        "cases:\n  - grid:\n      speed: 500",
        "sweep.yaml:6:14: cases.0.grid.speed: found 500, expected a rotational speed greater than 0 with its unit, e.g. '500 rpm'",
    ),
    (
        "cases:\n  - grid:\n      sped: [500 rpm]",
        "sweep.yaml:6:7: cases.0.grid.sped: unknown key; expected one of joints, clearance, load, name, speed, ambient_pressure, gravity, crank, rod, crosshead, cylinder, housing, throws, frame, sensors, sample_rate, effects; did you mean 'speed'?",
    ),
    (
        "cases:\n  - grid:\n      joints.big_ned.contact.damping: [2e4 N s/m]",
        "sweep.yaml:6:7: cases.0.grid.joints.big_ned.contact.damping: unknown key; expected one of main, big_end, small_end, guide; did you mean 'big_end'?",
    ),
    (
        "cases:\n  - grid:\n      joints.big_end.contact.dampign: [2e4 N s/m]",
        "sweep.yaml:6:7: cases.0.grid.joints.big_end.contact.dampign: unknown key; expected one of law, stiffness, exponent, damping, depth, materials, relation, at_clearance, restitution, slowest_approach, length, modulus; did you mean 'damping'?",
    ),
    (
        "cases:\n  - grid:\n      crank.radius: [120 mm, 700 mm]",
        "sweep.yaml:5:5: cases.0: case 1 of this block: rod.length: found '600 mm', expected a length above the crank radius, 0.7 m",
    ),
    (
        "cases:\n  - grid:\n      load: [{suction: 0.1 MPa, dischrge: 0.4 MPa}]",
        "sweep.yaml:6:33: cases.0.grid.load.0.dischrge: unknown key; expected one of suction, discharge; did you mean 'discharge'?",
    ),
    (
        "cases:\n  - grid:\n      load: [0.4 MPa]",
        "sweep.yaml:6:14: cases.0.grid.load.0: found \"0.4 MPa\", expected '{suction: 0.1 MPa, discharge: 0.4 MPa}'",
    ),
    (
        "cases:\n  - grid:\n      load: [{suction: 0.5 MPa, discharge: 0.4 MPa}]",
        "sweep.yaml:6:13: cases.0.grid.load: found '0.4 MPa', expected a pressure of at least suction, 500000 Pa",
    ),
    (
        "cases:\n  - gird: {speed: 500 rpm}",
        "sweep.yaml:5:5: cases.0: found 'gird', expected one of grid, zip, random; did you mean 'grid'?",
    ),
    (
        "cases:\n  - zip: {speed: [400 rpm, 500 rpm], load: [{suction: 0.1 MPa}, {suction: 0.2 MPa}, {suction: 0.3 MPa}]}",
        "sweep.yaml:5:44: cases.0.zip.load: found 3 values, expected 2 values, as cases.0.zip.speed has, or one",
    ),
    (
        "cases:\n  - random: {count: 0, axes: {}}",
        "sweep.yaml:5:21: cases.0.random.count: found 0, expected a whole number from 1 to 4294967295",
    ),
    (
        "cases:\n  - random: {count: 4, design: sobl, axes: {}}",
        "sweep.yaml:5:32: cases.0.random.design: found 'sobl', expected one of sobol, latin_hypercube, random; did you mean 'sobol'?",
    ),
    (
        "cases:\n  - random:\n      count: 4\n      axes:\n        speed: {unifrom: [400 rpm, 500 rpm]}",
        "sweep.yaml:8:16: cases.0.random.axes.speed: found 'unifrom', expected one of uniform, log_uniform, normal, lognormal, choice; did you mean 'uniform'?",
    ),
    (
        "cases:\n  - random:\n      count: 4\n      axes:\n        speed: {uniform: [500 rpm, 400 rpm]}",
        "sweep.yaml:8:36: cases.0.random.axes.speed.uniform.1: found '400 rpm', expected at least the lower end, 500 rpm",
    ),
    (
        "cases:\n  - random:\n      count: 4\n      axes:\n        speed: {uniform: [500 rpm, 400 Pa]}",
        "sweep.yaml:8:26: cases.0.random.axes.speed.uniform: found 400 Pa beside 500 rpm, expected values of one kind",
    ),
    (
        "cases:\n  - random:\n      count: 4\n      axes:\n        speed: {uniform: [400, 500]}",
        "sweep.yaml:8:16: cases.0.random.axes.speed: found 415.6143796269467, expected a rotational speed greater than 0 with its unit, e.g. '500 rpm'",
    ),
    (
        "cases:\n  - random:\n      count: 4\n      axes:\n        speed: {log_uniform: [0 rpm, 500 rpm]}",
        "sweep.yaml:8:31: cases.0.random.axes.speed.log_uniform.0: found 0 rpm, expected more than 0",
    ),
    (
        "cases:\n  - random:\n      count: 4\n      axes:\n        speed: {lognormal: {factor: 0.5}}",
        "sweep.yaml:8:37: cases.0.random.axes.speed.lognormal.factor: found 0.5, expected a plain number of at least 1",
    ),
    (
        "cases:\n  - random:\n      count: 4\n      axes:\n        speed: {uniform: [400 rpm, 500 rpm], normal: {deviation: 5 rpm}}",
        "sweep.yaml:8:16: cases.0.random.axes.speed: 'normal' is one rule too many: give one alone",
    ),
    (
        "cases:\n  - random:\n      count: 4\n      axes:\n        speed: {choice: {values: [400 rpm], weights: [1, 2]}}",
        "sweep.yaml:8:54: cases.0.random.axes.speed.choice.weights: found 2 weights, expected one per value, 1, not all 0",
    ),
    (
        "cases:\n  - grid: {speed: 500 rpm}\nvary:\n  joints.big_end.contact.damping: {lognormal: {fctor: 1.2}}",
        "sweep.yaml:7:48: vary.joints.big_end.contact.damping.lognormal.fctor: unknown key; expected one of median, factor, range; did you mean 'factor'?",
    ),
    (
        "cases:\n  - grid: {speed: 500 rpm}\nvary:\n  joints.bigend.contact.damping: {lognormal: {factor: 1.2}}",
        "sweep.yaml:7:3: vary.joints.bigend.contact.damping: unknown key; expected one of main, big_end, small_end, guide; did you mean 'big_end'?",
    ),
    (
        "cases:\n  - grid: {speed: 500 rpm}\nvary:\n  joints.big_end.contact.law: {lognormal: {factor: 1.2}}",
        "sweep.yaml:7:31: vary.joints.big_end.contact.law: found no number in the machine file, expected one to vary about",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nvary:\n  rod.mass: {lognormal: {factor: 1.1, range: [12 kg, 11 kg]}}",
        "sweep.yaml:6:54: vary.rod.mass.lognormal.range.1: found '11 kg', expected at least the lower end, 12 kg",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nvary_together:\n  - {parameters: {rod.mss: {lognormal: {factor: 1.1}}}, correlations: [[1]]}",
        "sweep.yaml:6:19: vary_together.0.parameters.rod.mss: unknown key; expected one of length, mass, centre_of_mass, inertia; did you mean 'mass'?",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nvary_together:\n  - {parameters: {rod.mass: {uniform: [1 kg, 2 kg]}}, correlations: [[1]]}",
        "sweep.yaml:6:29: vary_together.0.parameters.rod.mass: found 'uniform', expected one of normal, lognormal",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nvary_together:\n  - {parameters: {rod.mass: {lognormal: {factor: 1.1}}, crosshead.mass: {lognormal: {factor: 1.1}}}, correlations: [[1]]}",
        "sweep.yaml:6:116: vary_together.0.correlations: found 1 rows, expected a symmetric matrix with ones on its diagonal, 2 rows of 2",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nvary_together:\n  - {parameters: {rod.mass: {lognormal: {factor: 1.1}}, crosshead.mass: {lognormal: {factor: 1.1}}}, correlations: [[1, 0.5], [0.4, 1]]}",
        "sweep.yaml:6:121: vary_together.0.correlations.0.1: found 0.5, expected a symmetric matrix with ones on its diagonal, 2 rows of 2",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nvary_together:\n  - {parameters: {rod.mass: {lognormal: {factor: 1.1}}, crosshead.mass: {lognormal: {factor: 1.1}}}, correlations: [[1, 1.5], [1.5, 1]]}",
        "sweep.yaml:6:116: vary_together.0.correlations: found correlations that contradict each other, expected those of some distribution: a matrix without negative eigenvalues",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nvary: {rod.mass: [11 kg, 12 kg]}\nvary_together:\n  - {parameters: {rod.mass: {lognormal: {factor: 1.1}}}, correlations: [[1]]}",
        "sweep.yaml:7:29: vary_together.0.parameters.rod.mass: found an unknown that varies already, expected it once",
    ),
    (
        "cases:\n  - grid: {speed: 500 rpm}\nsplits: {train: 80 %, test: 30 %}",
        "sweep.yaml:6:9: splits: found 110 % together, expected shares that add up to 100 %",
    ),
    (
        "cases:\n  - grid: {speed: 500 rpm}\nsplits: {train: 0.8, test: 0.2}",
        "sweep.yaml:6:17: splits.train: found 0.8, expected a percentage from 0 to 100 % with its unit, e.g. '5 %'\nsweep.yaml:6:28: splits.test: found 0.2, expected a percentage from 0 to 100 % with its unit, e.g. '5 %'",
    ),
    (
        "cases:\n  - grid: {speed: 500 rpm}\nwindows: {count: 3, revolutions: 2}",
        "sweep.yaml:6:10: windows: found 3 windows of 2 revolutions, expected no more than run.revolutions, 4",
    ),
    (
        "cases:\n  - grid: {speed: {from: 400 rpm, to: 500 rpm, count: 1}}",
        "sweep.yaml:5:55: cases.0.grid.speed.count: found 1, expected a whole number from 2 to 1000000",
    ),
    (
        "cases:\n  - grid: {speed: {from: 400 rpm, to: 500 Pa, count: 3}}",
        "sweep.yaml:5:19: cases.0.grid.speed: found 500 Pa beside 400 rpm, expected values of one kind",
    ),
    (
        "cases:\n  - grid: {speed: 500 rpm}\nseed: -1",
        "sweep.yaml:6:7: seed: found -1, expected a whole number from 0 to 4294967295",
    ),
    (
        "cases:\n  - grid: {speed: 500 rpm}\nformat: csv",
        "sweep.yaml:6:9: format: found 'csv', expected one of parquet, mcap",
    ),
    (
        "cases:\n  - grid:\n      sensors: [[{measure: crank_angle}]]",
        "sweep.yaml:6:16: cases.0.grid.sensors: found sensors that measure something else, expected those of the machine file",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: joints.big_ned.clearance, from: 0.1 mm, to: 0.2 mm}",
        "sweep.yaml:6:41: bifurcations.0.path: unknown key; expected one of main, big_end, small_end, guide; did you mean 'big_end'?",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: speed, from: 0.1 mm, to: 0.2 mm}",
        "sweep.yaml:6:60: bifurcations.0.from: found '0.0001 m' (a length), expected a rotational speed greater than 0 with its unit, e.g. '500 rpm'",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: joints.big_end.clearance, from: 0.1 mm, to: 80 mm}",
        "sweep.yaml:6:91: bifurcations.0.to: found '0.08 m', expected a radial clearance below journal_radius, 0.05 m, or a diametral one below 0.1 m",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: joints.big_end.clearance, from: 0.2 mm, to: 0.1 mm}",
        "sweep.yaml:6:91: bifurcations.0.to: found 0.0001 m, expected more than 0.0002 m, where it begins",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: joints.big_end.clearance, from: 0.2 mm, to: 500 rpm}",
        "sweep.yaml:6:91: bifurcations.0.to: found 500 rpm beside 0.0002 m, expected values of one kind",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: load, from: 0.2 mm, to: 0.3 mm}",
        "sweep.yaml:6:47: bifurcations.0.path: found load, expected the path of one number, e.g. cylinder.discharge",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: clearance, from: 0.1 mm, to: 0.2 mm}",
        "sweep.yaml:6:47: bifurcations.0.path: found a clearance without joints, expected joints beside it, e.g. 'joints: [big_end]'",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: clearance, from: 0.1 mm, to: 0.2 mm, joints: [big_edn]}",
        "sweep.yaml:6:93: bifurcations.0.joints.0: found 'big_edn', expected one of main, big_end, small_end, guide; did you mean 'big_end'?",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: joints.main.clearance, from: 0.1 mm, to: 0.2 mm, joints: [big_end]}",
        "sweep.yaml:6:47: bifurcations.0.path: found joints.main.clearance, expected main among joints",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: speed, from: 300 rpm, to: 500 rpm, joints: [big_end]}",
        "sweep.yaml:6:90: bifurcations.0.joints: found joints without clearance, expected their clearance as path, or beside it, e.g. 'set: {clearance: 0.2 mm}'",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: speed, from: 300 rpm, to: 500 rpm, set: {rod.mass: 3 m}}",
        "sweep.yaml:6:98: bifurcations.0.set.rod.mass: found '3 m' (a length), expected a mass greater than 0 with its unit, e.g. '12 kg'",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: crosshead.mass, from: 1, to: 2}",
        "sweep.yaml:6:69: bifurcations.0.from: found 1, expected a mass greater than 0 with its unit, e.g. '12 kg'",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: speed, from: 300 rpm, to: 500 rpm, at: 3}",
        "sweep.yaml:6:86: bifurcations.0.at: found 3, expected an angle with its unit, e.g. '30 deg'",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: speed, from: 300 rpm, to: 500 rpm, directions: sideways}",
        "sweep.yaml:6:94: bifurcations.0.directions: found 'sideways', expected one of up, down, both",
    ),
    (
        "cases: [{grid: {sample_rate: [5 kHz, 10 kHz]}}]",
        "sweep.yaml:4:30: cases.0.grid.sample_rate: found sample_rate, expected one rate for all cases, as run.sample_rate, e.g. 10 kHz",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a/b, revolutions: 2, steps: 3, path: speed, from: 300 rpm, to: 500 rpm}",
        "sweep.yaml:6:12: bifurcations.0.name: found 'a/b', expected letters, digits, '-' and '_', e.g. big-end-clearance",
    ),
    (
        "cases: [{grid: {speed: 500 rpm}}]\nbifurcations:\n  - {name: a, revolutions: 2, steps: 3, path: speed, from: 300 rpm, to: 500 rpm}\n  - {name: a, revolutions: 2, steps: 3, path: speed, from: 300 rpm, to: 500 rpm}",
        "sweep.yaml:7:12: bifurcations.1.name: found a, expected another name than the diagrams before",
    ),
];

#[test]
fn every_mistake_gets_its_message() {
    let wrong = MISTAKES.iter().filter_map(|(rest, expected)| {
        let found = plan(&format!("{HEAD}{rest}")).map(|plan| plan.cases());
        let found = found.unwrap_err().to_string();
        (found != *expected).then(|| format!("{rest}\n  found    {found}\n  expected {expected}"))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn all_mistakes_are_told_at_once() {
    let keys = |text: &str| {
        let mistakes = plan(text).unwrap_err().into_each();
        let keys = mistakes.iter().map(|e| e.key().to_owned());
        keys.collect::<Vec<_>>()
    };
    let cases =
        "cases: [{grid: {sped: [500 rpm]}}]\nvary:\n  crosshead.mass: {lognormal: {factor: 0.5}}\n";
    assert_eq!(
        keys(&format!("{HEAD}{cases}")),
        ["cases.0.grid.sped", "vary.crosshead.mass.lognormal.factor"]
    );
    let cases =
        "cases: [{gird: {speed: 8 kg}}]\nsplits: {train: 0.7, validation: 15 %, test: 15 %}\n";
    assert_eq!(
        keys(&format!("{HEAD}{cases}")),
        ["cases.0", "cases.0.gird.speed", "splits.train"]
    );
}

#[test]
fn a_mistake_in_the_machine_is_told_where_it_is() {
    // In a file of its own: that file's name and line.
    let missing = plan("name: test\nmachine: none.yaml\nrun: {revolutions: 4}\ncases: []");
    let text = missing.unwrap_err().to_string();
    assert!(
        text.ends_with("none.yaml: cannot be read: there is no such file"),
        "{text}"
    );
    // In the sweep: the sweep's line, below `machine`.
    let inline = plan(
        "name: test\nmachine:\n  name: a\n  speed: 500 rpm\n  crank: {radius: 120}\n\
         run: {revolutions: 4}\ncases: []",
    );
    let text = inline.unwrap_err().to_string();
    let expected = "sweep.yaml:5:19: machine.crank.radius: found 120, expected a length";
    assert!(text.starts_with(expected), "{text}");
}

#[test]
fn a_billion_cases_are_planned_but_not_run() {
    let head = "repeats: 1000\n";
    let random =
        "cases:\n  - random: {count: 1000000, axes: {speed: {uniform: [400 rpm, 500 rpm]}}}\n";
    let steps = "{from: 300 rpm, to: 600 rpm, count: 1000000}";
    let grid = format!("cases:\n  - grid: {{speed: {steps}}}\n");
    for cases in [random, &grid] {
        let plan = plan(&format!("{HEAD}{head}{cases}")).unwrap();
        assert_eq!(plan.cases(), 1_000_000_000);
        let estimate = plan.estimate();
        assert_eq!((estimate.rows, estimate.shards), (1_000_000_000, 3_906_250));
        // 4 revolutions of about 0.13 s, 10 kHz, 4 channels of 4 bytes.
        assert!(
            (7e13..1.1e14).contains(&estimate.bytes),
            "{:e}",
            estimate.bytes
        );
        let last = plan.case(999_999_999).unwrap();
        assert_eq!((last.id.as_str(), last.repeat), ("case-999999999", 999));

        let error = plan.check_size().unwrap_err();
        assert!(matches!(
            error,
            Error::TooManyCases {
                cases: 1_000_000_000,
                ..
            }
        ));
        assert!(error.is_input());
        let text = error.to_string();
        assert!(
            text.contains("at most 100000000") && text.contains("several sweeps"),
            "{text}"
        );
    }
    let huge = "{from: 300 rpm, to: 600 rpm, count: 1000000}";
    let axes = format!("speed: {huge}, rod.mass: {{from: 1 kg, to: 2 kg, count: 1000000}}");
    let axes = format!("{axes}, crosshead.mass: {{from: 1 kg, to: 2 kg, count: 1000000}}");
    let axes = format!("{axes}, cylinder.suction: {{from: 1 kPa, to: 2 kPa, count: 1000000}}");
    let text = plan(&format!("{HEAD}cases:\n  - grid: {{{axes}}}\n"))
        .unwrap_err()
        .to_string();
    assert!(text.contains("more than 2^64 combinations"), "{text}");
}

#[test]
fn a_dataset_has_the_name_of_a_folder() {
    let named = |name: &str| {
        let rest = HEAD.replace("name: test", &format!("name: \"{name}\""));
        plan(&format!("{rest}cases: [{{grid: {{speed: 500 rpm}}}}]"))
    };
    for name in ["paper2", "Bearing faults v1.2", "Lagerschäden_2", "日本"] {
        assert_eq!(named(name).unwrap().name, name);
    }
    let long = "a".repeat(61);
    for name in [
        "../../evil",
        "/evil",
        "a/b",
        "",
        ".",
        "..",
        ".a",
        "a.",
        "a ",
        "C:evil",
        &long,
    ] {
        let message = named(name).unwrap_err().to_string();
        let expected = format!(
            "sweep.yaml:1:7: name: found '{name}', expected the name of a folder: a letter or digit, \
             then letters, digits, '-', '_', '.' and spaces, 60 characters at most, e.g. \
             bearing-faults"
        );
        assert_eq!(message, expected);
    }
}
