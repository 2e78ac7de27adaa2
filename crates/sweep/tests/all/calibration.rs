//! Sweeps that calibrate their machine first: plans, the resolved sweep, what is kept.

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use sweep::calibration::{Calibration, Estimate, Relations, Sweep};
use sweep::dataset::{CALIBRATION, Claim, generate_in};
use sweep::{Case, Error, Existing, Options, Plan};

const STIFFNESS: &str = "joints.big_end.contact.stiffness";
const DAMPING: &str = "joints.big_end.contact.damping";
const FRICTION: &str = "joints.big_end.friction.coefficient";

const SWEEP: &str = "name: test
machine: MACHINE
calibrate: {bundle: bundle, uncertainty: sampled, undetermined: prior}
run: {revolutions: 2, transient: 1}
cases:
  - grid: {joints: [[], [big_end]], clearance: 0.1 mm, speed: [400 rpm, 500 rpm]}
vary:
  rod.mass: {lognormal: {factor: 1.01}}
";

/// The files of a calibration that are always there.
fn calibration_at(folder: &Path, machine: &Value) {
    fs::create_dir_all(folder).unwrap();
    let results = r#"{"parameters": {}}"#;
    fs::write(folder.join("calibration.json"), results).unwrap();
    let machine = input::yaml::to_string(machine).unwrap();
    fs::write(folder.join("machine.yaml"), machine).unwrap();
}

/// A sweep file beside a bundle with a run whose recording is a few bytes.
fn write(folder: &Path, text: &str) -> PathBuf {
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    let machine = machine.join("single-stage.yaml").display().to_string();
    let bundle = folder.join("bundle");
    fs::create_dir_all(&bundle).unwrap();
    let recordings = "runs:
  - id: run01
    file: run01.parquet
    channels: [{column: crosshead_acceleration_m_s2, unit: m/s2}]
";
    fs::write(bundle.join("recordings.yaml"), recordings).unwrap();
    fs::write(bundle.join("run01.parquet"), "recorded").unwrap();
    let path = folder.join("sweep.yaml");
    fs::write(&path, text.replace("MACHINE", &machine)).unwrap();
    path
}

fn calibration_of(sweep: &Sweep) -> Calibration {
    let mut machine = sweep.machine().unwrap().unwrap();
    input::paths::set(&mut machine, STIFFNESS, json!("19.5 GN/m^1.5")).unwrap();
    let estimate = |path: &str, value: Value, bounds: [Value; 2], deviation| Estimate {
        path: path.into(),
        value,
        bounds,
        logarithmic: true,
        deviation,
    };
    let gigas = |x: f64| json!(format!("{x} GN/m^1.5"));
    let damping = ["2e3 N s/m", "2e5 N s/m"].map(|text| json!(text));
    Calibration {
        machine,
        estimates: vec![
            estimate(
                STIFFNESS,
                gigas(19.5),
                [gigas(2.4), gigas(240.0)],
                Some(0.1),
            ),
            estimate(DAMPING, json!("2e4 N s/m"), damping, None),
            estimate(FRICTION, json!(0.05), [json!(0.005), json!(0.5)], Some(0.2)),
        ],
        correlations: vec![
            vec![1.0, 0.0, -0.9],
            vec![0.0, 1.0, 0.0],
            vec![-0.9, 0.0, 1.0],
        ],
        relations: Relations::default(),
        is_adequate: true,
    }
}

fn value(case: &Case, path: &str) -> f64 {
    let value = input::paths::get(&case.tree, path).unwrap().unwrap();
    sweep::sweep_file::Amount::from_value(value).unwrap().si
}

#[test]
fn the_resolved_sweep_holds_machine_and_uncertainty_and_no_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = Sweep::read(&write(folder.path(), SWEEP)).unwrap();
    let plan = sweep.calibrated(&calibration_of(&sweep)).unwrap();
    let resolved = plan.sweep();
    assert!(resolved.get("calibrate").is_none());
    let entry = &resolved["vary_together"][0];
    assert_eq!(entry["correlations"], json!([[1.0, -0.9], [-0.9, 1.0]]));
    let lognormal = &entry["parameters"][STIFFNESS]["lognormal"];
    assert_eq!(lognormal["median"], "19.5 GN/m^1.5");
    let factor = lognormal["factor"].as_f64().unwrap();
    assert!((factor - 0.1_f64.exp()).abs() < 1e-12, "{factor}");
    let prior = &resolved["vary"][DAMPING]["log_uniform"];
    assert_eq!(*prior, json!(["2e3 N s/m", "2e5 N s/m"]));

    let path = folder.path().join("resolved.yaml");
    fs::remove_dir_all(folder.path().join("bundle")).unwrap();
    fs::write(&path, input::yaml::to_string(resolved).unwrap()).unwrap();
    let again = Plan::read(&path).unwrap();
    assert_eq!(again.id, plan.id);
    for i in 0..plan.cases() {
        assert_eq!(again.case(i).unwrap().tree, plan.case(i).unwrap().tree);
    }
    let cases: Vec<Case> = (0..4).map(|i| plan.case(i).unwrap()).collect();
    for path in [STIFFNESS, DAMPING, FRICTION] {
        assert!(plan.parameters.iter().any(|p| p.path == path), "{path}");
        assert_ne!(value(&cases[0], path), value(&cases[1], path), "{path}");
    }
}

#[test]
fn uncertainty_is_drawn_only_on_request_and_where_the_sweep_does_not_vary_itself() {
    let folder = tempfile::tempdir().unwrap();
    let plain = SWEEP.replace(", uncertainty: sampled, undetermined: prior", "");
    let sweep = Sweep::read(&write(folder.path(), &plain)).unwrap();
    let plan = sweep.calibrated(&calibration_of(&sweep)).unwrap();
    assert!(plan.sweep().get("vary_together").is_none());
    assert_eq!(value(&plan.case(3).unwrap(), STIFFNESS), 19.5e9);
    assert_eq!(
        value(&sweep.nominal().unwrap().case(3).unwrap(), STIFFNESS),
        24e9
    );

    let own = format!("{SWEEP}  {FRICTION}: {{uniform: [0.04, 0.05]}}\n");
    let sweep = Sweep::read(&write(folder.path(), &own)).unwrap();
    let plan = sweep.calibrated(&calibration_of(&sweep)).unwrap();
    let entry = &plan.sweep()["vary_together"][0];
    assert_eq!(entry["correlations"], json!([[1.0]]));
    let friction = value(&plan.case(0).unwrap(), FRICTION);
    assert!((0.04..0.05).contains(&friction), "{friction}");
}

#[test]
fn mistakes_in_the_section_tell_their_line() {
    let folder = tempfile::tempdir().unwrap();
    for (section, expected) in [
        ("{}", "sweep.yaml:3:1: calibrate.bundle: missing"),
        (
            "{bundel: b}",
            "sweep.yaml:3:13: calibrate.bundel: unknown key; expected one of bundle",
        ),
        (
            "{bundle: b, uncertainty: smapled}",
            "sweep.yaml:3:37: calibrate.uncertainty: found 'smapled', expected one of ignored, sampled; did you mean 'sampled'?",
        ),
        (
            "{bundle: b, parameters: {rod.mass: {bounds: [5 kg, 4 kg]}}}",
            "calibrate.parameters.rod.mass.bounds: found 5 kg to 4 kg",
        ),
        (
            "{bundle: b, machine: m.yaml}",
            "sweep.yaml:3:12: calibrate: machine beside calibrate",
        ),
    ] {
        let text = SWEEP.replace(
            "{bundle: bundle, uncertainty: sampled, undetermined: prior}",
            section,
        );
        let error = Sweep::read(&write(folder.path(), &text))
            .unwrap_err()
            .to_string();
        assert!(error.contains(expected), "{error}");
    }
    // Its plan alone would be that of a machine that is not calibrated.
    let error = Plan::read(&write(folder.path(), SWEEP))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("calibrate: found a calibration to be made"),
        "{error}"
    );
    let bare = "name: test\nrun: {revolutions: 2}\ncases: []\n";
    let error = Sweep::read(&write(folder.path(), bare))
        .unwrap()
        .nominal()
        .unwrap_err();
    assert!(error.to_string().contains("machine: missing"), "{error}");
}

#[test]
fn a_calibration_is_kept_beside_the_dataset_until_it_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = Sweep::read(&write(folder.path(), SWEEP)).unwrap();
    let root = folder.path().join("out");
    let cancel = AtomicBool::new(false);
    let plain: String = SWEEP
        .split_inclusive('\n')
        .filter(|line| !line.contains("calibrate"))
        .collect();
    let machine = sweep.machine().unwrap().unwrap();
    let plain = plain.replace("MACHINE", &machine.to_string());
    fs::write(folder.path().join("plain.yaml"), plain).unwrap();
    let silent = |cases: &[Case]| cases.iter().map(|_| Err("not simulated".into())).collect();
    let generate = |claim: Claim, existing, plan: &Plan| {
        let options = Options {
            existing,
            threads: 1,
            cancel: &cancel,
            retry_failed: false,
            trial: None,
        };
        generate_in(claim, plan, &options, &silent, &mut ())
    };

    // Stopped during the calibration: the folder goes on without a word.
    let mut claim = Claim::new(&root, Existing::Refuse).unwrap();
    let calibration = claim.calibration(false).unwrap();
    assert_eq!(calibration, root.join(CALIBRATION));
    fs::create_dir(&calibration).unwrap();
    fs::write(calibration.join("calibration.json"), "half").unwrap();
    drop(claim);
    let mut claim = Claim::new(&root, Existing::Resume).unwrap();
    claim.calibration(false).unwrap();
    assert!(calibration.join("calibration.json").exists());
    calibration_at(&calibration, &machine);
    let plan = sweep.calibrated(&calibration_of(&sweep)).unwrap();
    generate(claim, Existing::Resume, &plan).unwrap();

    let manifest = || fs::read_to_string(root.join("manifest.json")).unwrap();
    assert!(manifest().contains("calibration/calibration.json"));
    // The resolved sweep takes it along.
    let resolved = Plan::read(&root.join("sweep.yaml")).unwrap();
    let copy = folder.path().join("copy");
    let claim = Claim::new(&copy, Existing::Refuse).unwrap();
    generate(claim, Existing::Refuse, &resolved).unwrap();
    assert_eq!(
        manifest(),
        fs::read_to_string(copy.join("manifest.json")).unwrap()
    );
    assert!(copy.join("calibration/calibration.json").exists());
    // Replaced by itself, it stays.
    let claim = Claim::new(&root, Existing::Overwrite).unwrap();
    generate(claim, Existing::Overwrite, &resolved).unwrap();
    assert!(calibration.join("calibration.json").exists());

    // Replaced with the same calibration, it stays.
    let mut claim = Claim::new(&root, Existing::Overwrite).unwrap();
    claim.calibration(true).unwrap();
    assert!(root.join("manifest.json").exists());
    generate(claim, Existing::Overwrite, &plan).unwrap();
    assert!(calibration.join("calibration.json").exists());
    // A dataset of another calibration is left alone unless it may be replaced.
    let mut claim = Claim::new(&root, Existing::Resume).unwrap();
    let error = claim.calibration(false).unwrap_err();
    assert!(matches!(error, Error::OtherCalibration(_)) && error.is_input());
    assert!(root.join("manifest.json").exists());
    drop(claim);
    let mut claim = Claim::new(&root, Existing::Overwrite).unwrap();
    claim.calibration(false).unwrap();
    assert!(!root.join("manifest.json").exists());
    generate(claim, Existing::Overwrite, &plan).unwrap();
    // A sweep without a calibration takes the old one away with the dataset.
    let claim = Claim::new(&root, Existing::Overwrite).unwrap();
    let plain = Sweep::read(&folder.path().join("plain.yaml")).unwrap();
    generate(claim, Existing::Overwrite, &plain.nominal().unwrap()).unwrap();
    assert!(!calibration.exists());
}

/// Recordings of one clearance state exclude no relation: every case draws one, the same for all
/// joints, with its weight.
#[test]
fn relations_that_the_recordings_do_not_exclude_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let many = SWEEP
        .replace("joints: [[], [big_end]]", "joints: [[big_end]]")
        .replace(
            "speed: [400 rpm, 500 rpm]",
            "speed: {from: 400 rpm, to: 500 rpm, count: 400}",
        );
    let sweep = Sweep::read(&write(folder.path(), &many)).unwrap();
    let mut calibration = calibration_of(&sweep);
    calibration.relations = Relations {
        weights: vec![
            (json!("eq5"), 1.0),
            (json!("conformal"), 2.0),
            (json!("constant"), 1.0),
        ],
        joints: ["joints.big_end", "joints.small_end"]
            .map(|joint| (joint.to_owned(), 5e-5))
            .to_vec(),
    };
    let plan = sweep.calibrated(&calibration).unwrap();
    let relation = |case: &Case, joint: &str| {
        let path = format!("joints.{joint}.contact.relation");
        let value = input::paths::get(&case.tree, &path).unwrap();
        value.and_then(Value::as_str).unwrap().to_owned()
    };
    let mut conformal = 0;
    let mut stiffness = std::collections::BTreeSet::new();
    for i in 0..plan.cases() {
        let case = plan.case(i).unwrap();
        let drawn = relation(&case, "big_end");
        assert_eq!(drawn, relation(&case, "small_end"));
        conformal += u32::from(drawn == "conformal");
        stiffness.insert(drawn);
    }
    assert_eq!(stiffness.len(), 3);
    // 400 draws at 1/2: a standard deviation of 10.
    assert!((160..240).contains(&conformal), "{conformal}");
    // The resolved sweep draws the same.
    let path = folder.path().join("resolved.yaml");
    fs::write(&path, input::yaml::to_string(plan.sweep()).unwrap()).unwrap();
    let again = Plan::read(&path).unwrap();
    assert_eq!(again.case(7).unwrap().tree, plan.case(7).unwrap().tree);

    // A single relation that is left is not drawn, nor one that the sweep varies itself.
    calibration.relations.weights.truncate(1);
    let resolved = sweep.calibrated(&calibration).unwrap();
    assert!(!resolved.sweep()["vary"].to_string().contains("relation"));
}

/// Exponents that one clearance state cannot tell are drawn between their bounds, even where other
/// undetermined values keep their nominal ones.
#[test]
fn undetermined_exponents_of_a_relation_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let text = SWEEP.replace(", undetermined: prior", "");
    let sweep = Sweep::read(&write(folder.path(), &text)).unwrap();
    let mut calibration = calibration_of(&sweep);
    let path = "joints.big_end.contact.relation";
    let exponents = json!({"stiffness": 0.0, "damping": -0.2});
    input::paths::set(&mut calibration.machine, path, exponents).unwrap();
    let at = "joints.big_end.contact.at_clearance";
    input::paths::set(&mut calibration.machine, at, json!("50 um")).unwrap();
    calibration.estimates[1] = Estimate {
        path: format!("{path}.damping"),
        value: json!(-0.2),
        bounds: [json!(-1.0), json!(0.5)],
        logarithmic: false,
        deviation: None,
    };
    let plan = sweep.calibrated(&calibration).unwrap();
    let uniform = &plan.sweep()["vary"][format!("{path}.damping")]["uniform"];
    assert_eq!(*uniform, json!([-1.0, 0.5]));
    assert!(plan.sweep()["vary"].get(DAMPING).is_none());
}

/// What a stranger's sweep file calls a calibration must not publish anything else.
#[test]
fn the_named_files_of_a_calibration_alone_are_copied() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let machine = Sweep::read(&write(folder.path(), SWEEP)).unwrap();
    let machine = machine.machine().unwrap().unwrap();
    let plan = |from: &str| {
        let text = SWEEP.replace(
            "calibrate: {bundle: bundle, uncertainty: sampled, undetermined: prior}",
            &format!("calibrated: {from}"),
        );
        Plan::read(&write(folder.path(), &text)).unwrap()
    };
    let begin = |from: &str| {
        let claim = Claim::new(&at("out"), Existing::Resume).unwrap();
        claim.open(&plan(from)).map_err(|error| error.to_string())
    };
    let link = |from: &str, to: &str| std::os::unix::fs::symlink(from, at(to)).unwrap();

    fs::create_dir(at("keys")).unwrap();
    fs::write(at("keys/secret"), "a key").unwrap();
    link("keys", "link");
    calibration_at(&at("linked"), &machine);
    fs::remove_file(at("linked/machine.yaml")).unwrap();
    link("../keys/secret", "linked/machine.yaml");
    calibration_at(&at("other"), &machine);
    fs::write(at("other/machine.yaml"), "a key").unwrap();
    calibration_at(&at("empty"), &machine);
    fs::write(at("empty/calibration.json"), "[]").unwrap();
    link("second", "first");
    link("first", "second");
    for (from, expected) in [
        ("keys", "it has no calibration.json"),
        ("link", "it is a link or a file"),
        ("first", "it is a link or a file"),
        ("linked", "machine.yaml: it is a link"),
        ("other", "machine.yaml:1:1: found text, expected a section"),
        ("empty", "no section `parameters`"),
    ] {
        let message = begin(from).unwrap_err();
        assert!(message.contains(expected), "{from}: {message}");
        assert!(!message.contains("a key"), "{message}");
        assert!(!at("out/_sweep/plan.json").exists(), "{from}");
        assert!(!at("out/calibration").exists(), "{from}");
    }

    calibration_at(&at("sound"), &machine);
    fs::write(at("sound/secret"), "a key").unwrap();
    link("second", "sound/first");
    link(".", "sound/second");
    fs::write(at("sound/report.html"), "its page").unwrap();
    begin("sound").unwrap();
    let copied = fs::read_dir(at("out/calibration")).unwrap();
    let mut copied: Vec<_> = copied.map(|entry| entry.unwrap().file_name()).collect();
    copied.sort();
    assert_eq!(copied, ["calibration.json", "machine.yaml", "report.html"]);
}
