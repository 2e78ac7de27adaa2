//! The machines that bundles describe, at the conditions of their runs.

use input::yaml::Document;
use input::{MachineFile, Resolved, from_bundle, machine_file, paths, run_settings};
use mechanism::Machine;
use mechanism::joints::revolute::Revolute;
use serde_json::{Value, json};
use simulate::sensor::{ChamberEnd, Measured};
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The content of an example's recordings.yaml.
fn bundle(name: &str) -> Value {
    let path = root().join("data/recordings").join(name);
    Document::open(&path.join("recordings.yaml")).unwrap().tree
}

/// The tree `machine` at the conditions of `run`.
fn at_run(mut machine: Value, run: &Value) -> Resolved {
    for (path, value) in run_settings(run, &machine).unwrap() {
        paths::set(&mut machine, &path, value).unwrap();
    }
    MachineFile::from_tree(&machine).unwrap().resolve().unwrap()
}

/// `machine` with what bundles do not tell taken from `other`.
fn completed(mut machine: Machine, other: &Machine) -> Machine {
    machine.crankshaft.mass = other.crankshaft.mass;
    machine.frame = other.frame.clone();
    for (throw, other) in machine.throws.iter_mut().zip(&other.throws) {
        throw.crosshead.inertia = other.crosshead.inertia;
    }
    machine
}

/// Compares every run that `like_shipped` picks with the shipped machine at its conditions.
fn compare(name: &str, shipped: &str, runs: std::ops::Range<usize>) {
    let bundle = bundle(name);
    let machine = from_bundle(&bundle["machine"]).unwrap();
    let shipped = machine_file::read(&root().join("data/machines").join(shipped)).unwrap();
    for run in runs {
        let run = &bundle["runs"][run];
        let shipped = at_run(shipped.to_tree().clone(), run);
        let ours = at_run(machine.clone(), run);
        assert_eq!(ours.speed, shipped.speed);
        assert_eq!(
            completed(ours.machine, &shipped.machine),
            shipped.machine,
            "{run}"
        );
    }
}

#[test]
fn single_stage_is_the_shipped_machine_in_every_run() {
    compare("example-single-stage", "single-stage.yaml", 0..7);
}

#[test]
fn two_stage_is_the_shipped_machine_where_no_joint_is_oversized() {
    compare("example-two-stage", "two-stage.yaml", 0..3);
}

#[test]
fn runs_set_speed_load_and_clearances() {
    let bundle = bundle("example-two-stage");
    let machine = from_bundle(&bundle["machine"]).unwrap();
    let settings = run_settings(&bundle["runs"][2], &machine).unwrap();
    let find = |path: &str| {
        settings
            .iter()
            .find(|(p, _)| p == path)
            .map(|(_, v)| v.clone())
    };
    // The reference speed, not the measured 540.2 rpm.
    assert_eq!(find("speed"), Some(json!("540 rpm")));
    assert_eq!(
        find("throws.throw2.cylinder.discharge"),
        Some(json!("900000 Pa"))
    );
    assert_eq!(settings.len(), 1 + 4 + 4);
    let last = at_run(machine, &bundle["runs"][3]).machine;
    let clearances = last.throws.iter().flat_map(|throw| {
        [&throw.big_end, &throw.small_end].map(|joint| joint.clear().unwrap().clearance)
    });
    assert_eq!(clearances.collect::<Vec<f64>>(), [1e-4, 8e-5, 1e-4, 2.5e-4]);
}

#[test]
fn an_ideal_joint_stays_ideal() {
    let bundle = bundle("example-single-stage");
    let machine = from_bundle(&bundle["machine"]).unwrap();
    let mut run = bundle["runs"][1].clone();
    run["joints"] =
        json!({"big_end": "ideal", "small_end": {"clearance_m": 1e-4}, "guide": "ideal"});
    let resolved = at_run(machine, &run).machine;
    assert_eq!(resolved.throws[0].big_end, Revolute::Ideal);
    assert!(resolved.throws[0].small_end.clear().is_some());
}

#[test]
fn sensors_are_those_of_a_bundle() {
    let measured = |name: &str| {
        let bundle = bundle(name);
        let machine = from_bundle(&bundle["machine"]).unwrap();
        let sensors = at_run(machine, &bundle["runs"][0]).sensors;
        assert!(sensors.iter().all(|s| s.chain.noise.is_none()));
        sensors.into_iter().map(|s| s.measured).collect::<Vec<_>>()
    };
    let of_throw = |throw| {
        let end = ChamberEnd::Head;
        [
            Measured::CrossheadAcceleration { throw },
            Measured::CylinderPressure { throw, end },
        ]
    };
    let [acceleration, pressure] = of_throw(0);
    let single = [acceleration, pressure, Measured::CrankAngle];
    assert_eq!(measured("example-single-stage"), single);
    let [other_acceleration, other_pressure] = of_throw(1);
    let two = [
        acceleration,
        other_acceleration,
        pressure,
        other_pressure,
        Measured::CrankAngle,
    ];
    assert_eq!(measured("example-two-stage"), two);
}

#[test]
fn what_a_user_may_add() {
    let bundle = bundle("example-single-stage");
    let mut machine = bundle["machine"].clone();
    machine["contact_relation"] = json!({"stiffness": -0.5});
    machine["contact_at_clearance_m"] = json!(1e-4);
    machine["contact_damping_nominal_n_s_m"] = json!({"big_end": 3e4, "small_end": 4e4});
    machine["normal_clearance_m"] = json!(1.2e-4);
    // The last run's small end has 0.25 mm.
    let tree = from_bundle(&machine).unwrap();
    let resolved = at_run(tree.clone(), &bundle["runs"][6]);
    assert_eq!(resolved.normal_clearance.throws[0].small_end, Some(1.2e-4));
    let stiffness = |joint: &Revolute| joint.clear().unwrap().contact.spring().0;
    let throw = &resolved.machine.throws[0];
    assert_eq!(stiffness(&throw.big_end), 24e9);
    assert!((stiffness(&throw.small_end) / (20e9 / 2.5_f64.sqrt()) - 1.0).abs() < 1e-12);
    let damping = paths::get(&tree, "joints.small_end.contact.damping").unwrap();
    assert_eq!(damping, Some(&json!("40000 N s/m")));

    // Without a design value the stiffness is that of Eq. (5), which the bundle's is rounded from.
    let mut machine = bundle["machine"].clone();
    let section = machine.as_object_mut().unwrap();
    section.remove("contact_stiffness_nominal_n_m15");
    let resolved = at_run(from_bundle(&machine).unwrap(), &bundle["runs"][0]);
    let found = stiffness(&resolved.machine.throws[0].big_end);
    assert!((found / 24e9 - 1.0).abs() < 5e-3, "{found:e}");
}

/// The message for an example's machine section after `change`.
fn refusal(name: &str, change: impl Fn(&mut Value)) -> String {
    let mut machine = bundle(name)["machine"].take();
    change(&mut machine);
    from_bundle(&machine).unwrap_err().to_string()
}

fn remove(section: &mut Value, key: &str) {
    section.as_object_mut().unwrap().remove(key).unwrap();
}

#[test]
fn wrong_machine_sections_are_told() {
    let single = |change: fn(&mut Value)| refusal("example-single-stage", change);
    let two = |change: fn(&mut Value)| refusal("example-two-stage", change);
    for (found, expected) in [
        (single(|m| remove(m, "rod_mass_kg")), "rod_mass_kg: missing"),
        (
            single(|m| m["rod_mas_kg"] = json!(12)),
            "rod_mas_kg: unknown key; expected one of name, type, gravity_m_s2, crank, throws, \
             stage, direction, crank_pin_angle_rad, crank_radius_m, stroke_m, rod_length_m, \
             rod_mass_kg, rod_big_end_to_cg_m, rod_inertia_cg_kg_m2, crosshead_mass_kg, \
             piston_radius_m, double_acting, piston_rod_radius_m, head_clearance_m, \
             crank_end_clearance_m, polytropic_exponent, polytropic_expansion_exponent, \
             back_pressure_pa, big_end_journal_radius_m, small_end_journal_radius_m, youngs_modulus_pa, \
             poisson_ratio, contact_exponent, contact_stiffness_nominal_n_m15, \
             contact_damping_nominal_n_s_m, contact_damping_depth_m, contact_relation, \
             contact_at_clearance_m, friction_coefficient_nominal, friction_slip_velocity_m_s, \
             normal_clearance_m; did you mean 'rod_mass_kg'?",
        ),
        (
            single(|m| m["stroke_m"] = json!(0.3)),
            "stroke_m: found 0.3, expected 0.24, twice crank_radius_m",
        ),
        (
            single(|m| m["rod_length_m"] = json!("600 mm")),
            "rod_length_m: found '600 mm', expected a plain number greater than 0",
        ),
        (
            single(|m| m["crank_end_clearance_m"] = json!(0.03)),
            "double_acting: found false, expected true, as crank_end_clearance_m is there",
        ),
        (
            single(|m| m["contact_relation"] = json!("eq6")),
            "contact_at_clearance_m: missing",
        ),
        (
            single(|m| {
                m["contact_relation"] = json!("eq6");
                m["contact_at_clearance_m"] = json!(1e-4);
            }),
            "contact_relation: found 'eq6', expected one of eq5, conformal, constant",
        ),
        (
            two(|m| m["throws"][1]["crank_pin_angle"] = json!(1)),
            "throws.1.crank_pin_angle: unknown key",
        ),
        (
            two(|m| remove(&mut m["throws"][0], "piston_rod_radius_m")),
            "throws.0.piston_rod_radius_m: missing",
        ),
        (
            two(|m| m["contact_damping_depth_m"] = json!(-1)),
            "contact_damping_depth_m: found -1, expected a plain number greater than 0",
        ),
        (
            two(|m| m["throws"][1]["direction"] = json!(2)),
            "throws.1.direction: found 2, expected 1 or -1",
        ),
        (
            two(|m| remove(&mut m["crank"], "mean_torque_n_m")),
            "crank.mean_torque_n_m: missing",
        ),
        (
            two(|m| m["throws"] = json!([])),
            "throws: found an empty list, expected at least one throw",
        ),
    ] {
        assert!(found.starts_with(expected), "{found}\n{expected}");
    }
}

#[test]
fn wrong_runs_are_told() {
    let bundle = bundle("example-two-stage");
    let machine = from_bundle(&bundle["machine"]).unwrap();
    let refusal = |change: fn(&mut Value)| {
        let mut run = bundle["runs"][0].clone();
        change(&mut run);
        run_settings(&run, &machine).unwrap_err().to_string()
    };
    for (found, expected) in [
        (
            refusal(|r| remove(r, "speed_reference_rpm")),
            "speed_reference_rpm: missing; expected the speed at which the motor of the free \
             crank gives its mean torque",
        ),
        (
            refusal(|r| r["load"]["throw3"] = json!({})),
            "load.throw3: unknown key; expected one of throw1, throw2; did you mean 'throw1'?",
        ),
        (
            refusal(|r| r["load"]["throw1"] = json!({"suction_pressure_pa": 1e5})),
            "load.throw1.discharge_pressure_pa: missing",
        ),
        (
            refusal(|r| r["joints"]["throw2"]["smal_end"] = json!("ideal")),
            "joints.throw2.smal_end: unknown key; expected one of big_end, small_end, guide; \
             did you mean 'small_end'?",
        ),
        (
            refusal(|r| r["joints"]["throw1"]["big_end"] = json!("idael")),
            "joints.throw1.big_end: found 'idael', expected 'ideal' or a section",
        ),
        (
            refusal(|r| r["joints"] = json!("ideal")),
            "joints: found 'ideal', expected a section with the keys throw1, throw2",
        ),
    ] {
        assert_eq!(found, expected);
    }
}

/// The machine of a bundle in the words of a machine file.
const IN_WORDS: &str = "
name: small
stroke: 150 mm
rod: {length: 400 mm, mass: 12 kg, centre_of_mass: 150 mm, inertia: 0.3 kg m^2}
reciprocating_mass: 18 kg
cylinder: {bore: 100 mm, head_clearance: 15 mm, exponent: 1.4, back: 1 bar}
";

/// The same as programs write it.
const IN_SI: &str = "
name: small
crank_radius_m: 0.075
rod_length_m: 0.4
rod_mass_kg: 12
rod_big_end_to_cg_m: 0.15
rod_inertia_cg_kg_m2: 0.3
crosshead_mass_kg: 18
piston_radius_m: 0.05
head_clearance_m: 0.015
polytropic_exponent: 1.4
back_pressure_pa: 100000
";

fn parsed(text: &str) -> Value {
    Document::parse(text, "m.yaml").unwrap().tree
}

#[test]
fn a_machine_section_and_a_machine_file_have_the_same_keys() {
    let run = json!({"speed_rpm": 740, "load": {"suction_pressure_pa": 1e5, "discharge_pressure_pa": 4e5}});
    let of_bundle = |text: &str| at_run(from_bundle(&parsed(text)).unwrap(), &run);
    assert_eq!(of_bundle(IN_WORDS), of_bundle(IN_SI));
    // Half and half.
    let mixed = IN_WORDS.replace("stroke: 150 mm", "stroke_m: 0.15");
    let mixed = mixed.replace("reciprocating_mass: 18 kg", "crosshead_mass_kg: 18");
    assert_eq!(of_bundle(&mixed), of_bundle(IN_SI));
    // A machine file as programs write a bundle.
    let rest = "speed_rpm: 740\nsuction_pressure_pa: 1.0e5\ndischarge_pressure_pa: 4.0e5\n";
    let file = |text: &str| MachineFile::from_tree(&parsed(&format!("{text}{rest}"))).unwrap();
    let machine = file(IN_SI).resolve().unwrap().machine;
    assert_eq!(machine, of_bundle(IN_SI).machine);
    assert_eq!(machine, file(IN_WORDS).resolve().unwrap().machine);
}

#[test]
fn mistakes_in_the_words_of_a_machine_file_are_told_together() {
    let text = format!(
        "machine:{}runs:\n  - {{id: a, file: a.csv, speed_rpm: 740, load: {{suction_pressure_pa: 1e5, \
         discharge_pressure_pa: 4e5}}, channels: [{{column: t_s, unit: s}}]}}\n",
        IN_WORDS
            .replace('\n', "\n  ")
            .trim_end_matches(' ')
            .replace("mass: 12 kg", "mass: 12")
            .replace("stroke: 150 mm", "stroke: 150 kg")
            .replace("back: 1 bar", "bck: 1 bar")
    );
    let document = Document::parse(&text, "recordings.yaml").unwrap();
    let error = input::check_bundle(Path::new("."), &document).unwrap_err();
    let keys: Vec<String> = error
        .into_each()
        .iter()
        .map(|e| e.key().to_owned())
        .collect();
    assert_eq!(
        keys,
        ["machine.stroke", "machine.rod.mass", "machine.cylinder.bck"]
    );
}
