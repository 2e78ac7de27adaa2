//! `crosshead replay` on a bundle that is simulated here, with its sensors' noise.

use crate::one_run;

use one_run::{bundle, crosshead, machine, said};
use recordings::formats::parquet::read_table;
use serde_json::Value;
use std::fs;

#[test]
fn a_bundle_is_replayed_to_within_its_noise() {
    let folder = tempfile::tempdir().unwrap();
    bundle(folder.path());
    let out = folder.path().join("replayed");
    let machine = machine();
    let arguments = |more: &[&'static str]| {
        let mut all = vec!["replay", folder.path().to_str().unwrap(), "--out"];
        all.push(out.to_str().unwrap());
        all.extend(more);
        crosshead(&all)
    };
    let without = arguments(&[]);
    assert_eq!(without.status.code(), Some(2));
    assert!(said(&without).contains("--machine"), "{without:?}");
    assert!(!out.exists());
    let with_machine = |more: &[&str]| {
        let mut all = vec!["replay", folder.path().to_str().unwrap()];
        all.extend(["--machine", machine.to_str().unwrap()]);
        all.extend(["--out", out.to_str().unwrap()]);
        all.extend(more);
        crosshead(&all)
    };
    let unknown = with_machine(&["--leave-out", "run1"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(said(&unknown).contains("run01"), "{unknown:?}");

    let replayed = with_machine(&[]);
    assert!(replayed.status.success(), "{replayed:?}");
    let recording = read_table(&folder.path().join("signals.parquet")).unwrap();
    let replay = read_table(&out.join("run01.parquet")).unwrap();
    let names: Vec<&str> = replay
        .schema()
        .columns()
        .iter()
        .map(|c| c.name.as_str())
        .collect();
    let listed = [
        "t_s",
        "crank_angle_rad",
        "crosshead_acceleration_m_s2",
        "cylinder_pressure_pa",
    ];
    assert_eq!(names, listed);
    assert_eq!(replay.rows(), recording.rows());
    let times = |table: &recordings::Table| table.values::<f64>("t_s").unwrap().to_vec();
    for (a, b) in times(&replay).iter().zip(times(&recording)) {
        assert!((a.unwrap() - b.unwrap()).abs() < 1e-9);
    }
    let results = fs::read_to_string(out.join("replay.json")).unwrap();
    let results: Value = serde_json::from_str(&results).unwrap();
    let run = &results["runs"]["run01"];
    let misfit = run["misfit"].as_f64().unwrap();
    assert!((0.8..1.25).contains(&misfit), "{misfit}");
    let acceleration = &run["channels"]["crosshead_acceleration_m_s2"];
    let ratio = acceleration["difference"].as_f64().unwrap()
        / acceleration["noise_floor"].as_f64().unwrap();
    assert!((0.8..1.25).contains(&ratio), "{ratio}");

    let again = with_machine(&[]);
    assert_eq!(again.status.code(), Some(2));
    assert!(said(&again).contains("--overwrite"), "{again:?}");
    let bytes = fs::read(out.join("run01.parquet")).unwrap();
    assert!(with_machine(&["--overwrite"]).status.success());
    assert!(fs::read(out.join("run01.parquet")).unwrap() == bytes);
}

/// A machine whose contact is known at another clearance than the run's: no interval came with its
/// replay.
#[test]
fn another_clearance_gives_a_spread_over_the_relations() {
    let folder = tempfile::tempdir().unwrap();
    bundle(folder.path());
    let text = fs::read_to_string(machine()).unwrap();
    let mut tree = input::MachineFile::from_yaml(&text, "machine.yaml")
        .unwrap()
        .to_tree()
        .clone();
    let contact = "joints.big_end.contact";
    for (key, value) in [("relation", "eq5"), ("at_clearance", "0.03 mm")] {
        input::paths::set(&mut tree, &format!("{contact}.{key}"), value.into()).unwrap();
    }
    let file = folder.path().join("machine.yaml");
    fs::write(&file, input::yaml::to_string(&tree).unwrap()).unwrap();
    let replay = |out: &str| {
        let out = folder.path().join(out);
        let arguments = ["replay", folder.path().to_str().unwrap(), "--machine"];
        let more = [file.to_str().unwrap(), "--out", out.to_str().unwrap()];
        let output = crosshead(&[&arguments[..], &more].concat());
        assert!(output.status.success(), "{output:?}");
        let results = fs::read_to_string(out.join("replay.json")).unwrap();
        let results: Value = serde_json::from_str(&results).unwrap();
        (
            String::from_utf8(output.stdout).unwrap(),
            results["runs"]["run01"]["relation_spread"].clone(),
        )
    };
    let (text, spread) = replay("all");
    assert!(text.contains("eq5, conformal, constant"), "{text}");
    let joint = &spread["joints"]["joints.big_end"];
    assert_eq!(joint["stated_for_m"], 3e-5);
    let acceleration = &spread["channels"]["crosshead_acceleration_m_s2"];
    let ends = |key: &str| [0, 1].map(|i| acceleration[key][i].as_f64().unwrap());
    // The recording's contact does not depend on the clearance: the constant relation is the truth.
    let [least, greatest] = ends("difference");
    assert!(least < 0.01 && greatest > 2.0 * least, "{acceleration}");
    let [low, high] = ends("peak");
    assert!(low < high, "{acceleration}");

    // Recordings that exclude all but one leave no spread.
    let decided = serde_json::json!({
        "optimiser": "levenberg-marquardt",
        "evaluations": 1,
        "complete": true,
        "model_is_adequate": true,
        "fingerprint": "",
        "parameters": {},
        "fit": {"unit": "", "noise_floor": 1.0},
        "runs": {},
        "relations": {
            "decision": {"relations": ["eq5"], "runs": "fitted"},
            "compared": [{
                "relation": "eq5", "exponents": {}, "fitted": 1.0, "runs": {}, "criterion": 0.0
            }],
        },
    });
    fs::write(folder.path().join("calibration.json"), decided.to_string()).unwrap();
    let (_, spread) = replay("one");
    let acceleration = &spread["channels"]["crosshead_acceleration_m_s2"];
    let peaks = &acceleration["peak"];
    assert_eq!(peaks[0], peaks[1]);
}
