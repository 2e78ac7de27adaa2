//! Sweep files become cases.

use input::yaml::Document;
use proptest::collection::vec;
use proptest::prelude::*;
use rand::Rng;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use sweep::{Case, Plan};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn shipped(name: &str) -> Plan {
    Plan::read(&root().join("pipelines").join(name)).unwrap()
}

/// A plan of the single-stage machine with these `cases` and what else the file says.
fn plan(rest: &str) -> Result<Plan, input::Error> {
    let text = format!(
        "name: test\nmachine: single-stage.yaml\nrun: {{revolutions: 4, transient: 2}}\n{rest}"
    );
    let document = Document::parse(&text, "sweep.yaml")?;
    Plan::new(&document, &root().join("data/machines"))
}

#[test]
fn the_papers_runs() {
    let plan = shipped("paper2.yaml");
    let labels: Vec<String> = (0..plan.cases())
        .map(|i| {
            let labels = plan.case(i).unwrap().labels;
            let [main, big, small, guide] = labels.clearances_m[..] else {
                panic!("four joints");
            };
            assert_eq!([main, guide], [0.0; 2]);
            format!("{} {} {big} {small}", labels.fault, labels.faulty_joints)
        })
        .collect();
    let expected = [
        "none 0 0 0",
        "big_end 1 0.0001 0",
        "big_end 1 0.0002 0",
        "big_end 1 0.0003 0",
        "small_end 1 0 0.0001",
        "small_end 1 0 0.0002",
        "small_end 1 0 0.0003",
        "big_end+small_end 2 0.0001 0.0001",
        "big_end+small_end 2 0.0002 0.0002",
        "big_end+small_end 2 0.0003 0.0003",
    ];
    assert_eq!(labels, expected);
    assert_eq!(plan.case_id(3), "case-000003");
}

/// A key of the joints is set in every joint that the sets name, so that cases with clearance in other
/// joints differ in nothing else; a stiffness by a formula is text, and no number that is missing.
#[test]
fn the_papers_runs_at_every_setting_of_the_contact() {
    let plan = shipped("paper2-sensitivity.yaml");
    assert_eq!(plan.cases(), 4 * 2 * 2 * (1 + 9));
    let keys = ["damping", "depth", "stiffness"];
    let of = |joint: &str| {
        let own = plan.parameters.iter().filter(|p| p.path.contains(joint));
        own.map(|p| p.is_number).collect::<Vec<_>>()
    };
    assert_eq!(of("big_end"), [true, true, false]);
    assert_eq!(of("small_end"), [true, true, false]);
    assert_eq!(plan.parameters.len(), 6);
    let mut settings = BTreeSet::new();
    for index in 0..plan.cases() {
        let tree = plan.case(index).unwrap().tree;
        let [big, small] = ["big_end", "small_end"]
            .map(|joint| keys.map(|key| tree["joints"][joint]["contact"][key].to_string()));
        assert_eq!(big, small, "case {index}");
        settings.insert(big);
    }
    assert_eq!(settings.len(), 16);
}

#[test]
fn every_choice_of_the_two_stage_machines_four_joints() {
    let plan = shipped("two-stage.yaml");
    let cases = all(&plan, |case| (case.labels, case.id));
    assert_eq!(cases.len(), 1 + 15 * 3);
    let faults: BTreeSet<&str> = cases.iter().map(|(l, _)| l.fault.as_str()).collect();
    assert_eq!(faults.len(), 16);
    for fault in ["none", "throw2.small_end", "throw1.big_end+throw2.big_end"] {
        assert!(faults.contains(fault), "{fault}");
    }
    for (labels, id) in cases {
        let [main, big1, small1, guide1, big2, small2, guide2] = labels.clearances_m[..] else {
            panic!("seven joints");
        };
        assert_eq!([main, guide1, guide2], [0.0; 3]);
        let normal = [1e-4, 8e-5, 1e-4, 8e-5];
        let worn = [big1, small1, big2, small2];
        let worn = worn.iter().zip(normal).filter(|(c, normal)| **c != *normal);
        assert_eq!(worn.count(), labels.faulty_joints, "{id}");
    }
}

#[test]
fn bearing_faults_stay_in_their_ranges() {
    let plan = shipped("bearing-faults.yaml");
    assert_eq!(plan.cases(), 2048);
    let mut faults = BTreeMap::new();
    for i in 0..256 {
        let case = plan.case(i).unwrap();
        *faults.entry(case.labels.fault.clone()).or_insert(0) += 1;
        for (&clearance, joint) in case.labels.clearances_m[1..3].iter().zip(["big", "small"]) {
            let range = if case.labels.fault.contains(joint) {
                1e-4..=4e-4
            } else {
                1e-5..=3e-5
            };
            assert!(range.contains(&clearance), "{}: {clearance}", case.id);
        }
        let point = &case.operating_point;
        assert!((350.0..=650.0).contains(&point.speed_rpm));
        assert!((0.30e6..=0.45e6).contains(&point.pressures_pa[0][1]));
        assert_eq!(point.pressures_pa[0][0], 0.105e6);
    }
    // Sobol's points with four equally likely choices: exactly a quarter each.
    assert_eq!(faults.into_values().collect::<Vec<i32>>(), [64; 4]);
    let case = plan.case(9).unwrap();
    let columns: Vec<&str> = plan.parameters.iter().map(|p| p.column.as_str()).collect();
    assert!(
        columns.contains(&"joints.big_end.contact.stiffness_n_m15"),
        "{columns:?}"
    );
    assert!(columns.contains(&"joints.small_end.contact.damping_n_s_m"));
    assert!(columns.contains(&"joints.small_end.friction.coefficient"));
    assert!(columns.contains(&"crosshead.mass_kg"));
    assert_eq!(case.resolved.sensors.len(), 4);
}

/// What `read` says of every case, in order.
fn all<T>(plan: &Plan, read: impl Fn(Case) -> T) -> Vec<T> {
    (0..plan.cases())
        .map(|i| read(plan.case(i).unwrap()))
        .collect()
}

/// Clearances of big and small end in units of 0.1 mm.
fn tenths(case: &Case) -> [f64; 2] {
    let c = &case.labels.clearances_m;
    [c[1], c[2]].map(|c| (c * 1e10).round() / 1e6)
}

#[test]
fn a_clearance_axis_counts_only_where_a_joint_has_it() {
    let grid = plan(
        "cases:
  - grid:
      joints: [[], [big_end], [small_end, big_end]]
      clearance: [0.1 mm, 0.2 mm]
      joints.small_end.clearance: [0.3 mm, 0.4 mm]
",
    );
    let expected = [
        [0., 0.],
        [1., 0.],
        [2., 0.],
        [1., 3.],
        [1., 4.],
        [2., 3.],
        [2., 4.],
    ];
    assert_eq!(all(&grid.unwrap(), |case| tenths(&case)), expected);
    // Without an axis of joints a clearance is a path like any other.
    let direct = plan("cases:\n  - grid: {joints.small_end.clearance: [0 mm, 0.4 mm]}\n").unwrap();
    assert_eq!(all(&direct, |case| tenths(&case)), [[0., 0.], [0., 4.]]);
}

#[test]
fn contact_parameters_follow_the_clearance_of_a_case() {
    let plan = plan(
        "cases:
  - grid:
      joints: [[], [big_end]]
      clearance: [0.1 mm, 0.3 mm]
      joints.big_end.contact.relation: conformal
      joints.big_end.contact.at_clearance: 0.1 mm
",
    );
    let stiffness = all(&plan.unwrap(), |case| {
        let joint = case.resolved.machine.throws[0].big_end.clear().cloned();
        joint.map(|clear| clear.contact.spring().0)
    });
    // R₁R₂/(R₂ - R₁) with R₁ = 50 mm, R₂ = 50.1 and 50.3 mm.
    let wide = 24e9 * ((2515.0 / 0.3) / (2505.0 / 0.1_f64)).sqrt();
    let [None, Some(narrow), Some(found)] = stiffness[..] else {
        panic!("{stiffness:?}")
    };
    assert_eq!(narrow, 24e9);
    assert!((found / wide - 1.0).abs() < 1e-9, "{found} {wide}");
}

#[test]
fn lists_go_side_by_side_and_ranges_have_equal_steps() {
    let zip = plan(
        "cases:
  - zip:
      joints: [[big_end]]
      clearance: {from: 0.1 mm, to: 0.4 mm, count: 3, spacing: log}
      speed: {from: 400 rpm, to: 600 rpm, count: 3}
      load: [{suction: 0.1 MPa, discharge: 0.3 MPa}, {discharge: 0.4 MPa}, {suction: 0.2 MPa}]
",
    );
    let found = all(&zip.unwrap(), |case| {
        let [suction, discharge] = case.operating_point.pressures_pa[0];
        let rpm = case.operating_point.speed_rpm;
        (tenths(&case)[0], rpm, suction, discharge)
    });
    let expected = [
        (1., 400., 0.1e6, 0.3e6),
        (2., 500., 0.105e6, 0.4e6),
        (4., 600., 0.2e6, 0.393e6),
    ];
    assert_eq!(found, expected);
}

#[test]
fn faults_of_one_case_draw_their_clearances_separately() {
    let random = plan(
        "cases:
  - random:
      design: latin_hypercube
      count: 100
      axes:
        joints: {choice: {values: [[], [big_end, small_end]], weights: [1, 3]}}
        clearance: {uniform: [0.1 mm, 0.3 mm]}
",
    );
    let found = all(&random.unwrap(), |case| tenths(&case));
    let faulty: Vec<_> = found.into_iter().filter(|c| *c != [0., 0.]).collect();
    // Exactly three of four, because each draw of a Latin hypercube is stratified.
    assert_eq!(faulty.len(), 75);
    assert!(faulty.iter().all(|[big, small]| big != small));
    // 75 pairs of independent uniform numbers: standard error of the correlation 0.115.
    let mean = |f: &dyn Fn(&[f64; 2]) -> f64| faulty.iter().map(f).sum::<f64>() / 75.0;
    let correlation = mean(&|[a, b]| (a - 2.0) * (b - 2.0)) * 3.0;
    assert!(correlation.abs() < 0.46, "{correlation}");
}

#[test]
fn what_a_case_sets_is_not_varied() {
    let plan = plan(
        "cases:
  - grid:
      joints: [[], [big_end]]
      clearance: 0.2 mm
vary:
  joints.big_end.clearance: {uniform: [0.01 mm, 0.02 mm]}
  joints.big_end.contact.damping: {lognormal: {factor: 1.5}}
",
    )
    .unwrap();
    let [healthy, faulty] = [0, 1].map(|i| plan.case(i).unwrap());
    assert!((1e-5..2e-5).contains(&healthy.labels.clearances_m[1]));
    assert_eq!(
        (healthy.labels.fault.as_str(), healthy.labels.faulty_joints),
        ("none", 0)
    );
    assert_eq!(faulty.labels.clearances_m[1], 2e-4);
    let damping = |case: &Case| format!("{:?}", case.resolved.machine.throws[0].big_end);
    assert_ne!(damping(&healthy), damping(&faulty));
}

#[test]
fn unknowns_that_vary_together_have_their_correlations_and_stay_in_their_range() {
    let plan = plan(
        "cases: [{random: {count: 4000, design: random, axes: {speed: 500 rpm}}}]
vary_together:
  - parameters:
      joints.big_end.contact.stiffness: {lognormal: {factor: 1.2}}
      rod.mass: {normal: {mean: 10 kg, deviation: 500 g, range: [9 kg, 10.5 kg]}}
      joints.big_end.friction.coefficient: {lognormal: {median: 0.06, factor: 1.1}}
    correlations: [[1, -0.8, 0], [-0.8, 1, 0.3], [0, 0.3, 1]]
",
    )
    .unwrap();
    let value = |case: &Case, path: &str| {
        let value = input::paths::get(&case.tree, path).unwrap().unwrap();
        sweep::sweep_file::Amount::from_value(value).unwrap().si
    };
    let drawn: Vec<[f64; 3]> = all(&plan, |case| {
        let stiffness = value(&case, "joints.big_end.contact.stiffness");
        let friction = value(&case, "joints.big_end.friction.coefficient");
        [
            (stiffness / 24e9).ln() / 1.2_f64.ln(),
            (value(&case, "rod.mass") - 10.0) / 0.5,
            (friction / 0.06).ln() / 1.1_f64.ln(),
        ]
    });
    let mean = |of: &dyn Fn(&[f64; 3]) -> f64| drawn.iter().map(of).sum::<f64>() / 4000.0;
    // Four standard errors of 4000 normal draws: of a mean 0.063, of a product at most 0.09.
    for i in [0, 2] {
        assert!(mean(&|z| z[i]).abs() < 0.063, "{}", mean(&|z| z[i]));
        assert!((mean(&|z| z[i] * z[i]) - 1.0).abs() < 0.09);
    }
    assert!(mean(&|z| z[0] * z[2]).abs() < 0.063);
    // The mass is cut off at -2 and 1 standard deviations, so often is it at its ends: Φ(-2) and
    // 1 - Φ(1), four standard errors.
    let share = |end: f64| mean(&|z| f64::from(u8::from((z[1] - end).abs() < 1e-9)));
    assert!((share(-2.0) - 0.02275).abs() < 0.0095, "{}", share(-2.0));
    assert!((share(1.0) - 0.15866).abs() < 0.0232, "{}", share(1.0));
    // Between the ends the product with the first follows its conditional mean -0.8 z.
    let inside = |z: &[f64; 3]| f64::from(u8::from(z[1] > -1.999 && z[1] < 0.999));
    let slope = mean(&|z| inside(z) * z[0] * z[1]) / mean(&|z| inside(z) * z[1] * z[1]);
    // Its standard error: 0.6/√(Σ z²), which is below 0.017.
    assert!((slope + 0.8).abs() < 0.068, "{slope}");
    let columns: Vec<&str> = plan.parameters.iter().map(|p| p.column.as_str()).collect();
    let expected = [
        "joints.big_end.contact.stiffness_n_m15",
        "rod.mass_kg",
        "joints.big_end.friction.coefficient",
    ];
    assert_eq!(columns, expected);
}

#[test]
fn twins_that_differ_in_noise_and_sensors_share_a_group() {
    let plan = plan(
        "repeats: 3
cases:
  - grid:
      speed: [400 rpm, 500 rpm]
      sensors.cylinder_pressure.noise.rms: [1 kPa, 2 kPa]
  # The same machine in other words; at an ideal joint nothing touches, so its damping is nothing.
  - grid: {speed: 52.35987755982988 rad/s, joints.big_end.contact.damping: [1e3 N s/m, 1e4 N s/m]}
",
    )
    .unwrap();
    let groups = all(&plan, |case| case.group);
    assert!(groups[..6].iter().all(|g| *g == groups[0]));
    assert!(groups[6..].iter().all(|g| *g == groups[6]));
    assert_ne!(groups[0], groups[6]);
    let noise = all(&plan, |case| Rng::next_u64(&mut case.noise()));
    let different: BTreeSet<u64> = noise.into_iter().collect();
    assert_eq!(different.len(), 18);
}

#[test]
fn joints_of_several_throws_carry_the_throws_name() {
    let single = std::fs::read_to_string(root().join("data/machines/single-stage.yaml")).unwrap();
    let tree = Document::parse(&single, "machine").unwrap().tree;
    let section = |key: &str| tree[key].clone();
    let throw = |name: &str, angle: &str| {
        let mut joints = section("joints");
        joints.as_object_mut().unwrap().remove("main");
        json!({
            "name": name, "crank_pin_angle": angle, "joints": joints, "rod": section("rod"),
            "crosshead": section("crosshead"), "cylinder": section("cylinder"),
        })
    };
    let machine = json!({
        "name": "two throws", "speed": "500 rpm", "crank": section("crank"),
        "joints": {"main": section("joints")["main"].clone()},
        "throws": [throw("throw1", "0 deg"), throw("throw2", "180 deg")],
        "sensors": [{"measure": "crosshead_acceleration", "throw": "throw2"}],
    });
    let sweep = json!({
        "name": "two", "machine": machine, "run": {"revolutions": 4},
        "cases": [{"grid": {
            "joints": [[], ["throw2.big_end", "main"], ["throw1.small_end"]],
            "clearance": "0.2 mm",
            "load": [{"throw1": {"discharge": "0.3 MPa"}, "throw2": {"discharge": "0.5 MPa"}}],
            "throws.throw1.rod.mass": ["12 kg"],
        }}],
    });
    let plan = Plan::new(&Document::from_tree(sweep), Path::new("")).unwrap();
    let faults = all(&plan, |case| case.labels.fault);
    assert_eq!(faults, ["none", "main+throw2.big_end", "throw1.small_end"]);
    let joints: Vec<&str> = plan.joints.iter().map(|j| j.name.as_str()).collect();
    let expected = [
        "main",
        "throw1.big_end",
        "throw1.small_end",
        "throw1.guide",
        "throw2.big_end",
        "throw2.small_end",
        "throw2.guide",
    ];
    assert_eq!(joints, expected);
    let pressures = plan.case(0).unwrap().operating_point.pressures_pa;
    assert_eq!(pressures, [[0.105e6, 0.3e6], [0.105e6, 0.5e6]]);
    assert_eq!(plan.channels()[0].0, "throw2.crosshead_acceleration_m_s2");
    let columns = sweep::dataset::Tables::new(&plan).unwrap().signals;
    let columns: Vec<&str> = columns.columns().iter().map(|c| c.name.as_str()).collect();
    for name in ["clearance_throw2.big_end_m", "throw2.discharge_pressure_pa"] {
        assert!(columns.contains(&name), "{columns:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever the sweep: no group is in two splits, a case does not depend on the others, and
    /// cases that differ in noise or sensors alone are together.
    #[test]
    fn splits_are_disjoint_by_group(
        seed in 0_u32..1000,
        repeats in 1_u32..4,
        speeds in vec(0_usize..3, 1..4),
        count in 1_u32..20,
        levels in 1_usize..4,
        train in 1_u32..99,
    ) {
        let speeds: Vec<String> = speeds.iter().map(|s| format!("{} rpm", 400 + 50 * s)).collect();
        let clearances = &["0.1 mm", "0.2 mm", "0.1 mm"][..levels];
        let text = format!(
            "seed: {seed}
repeats: {repeats}
cases:
  - grid:
      joints: [[], [big_end], []]
      clearance: {clearances:?}
      speed: {speeds:?}
      sensors.crosshead_acceleration.noise.rms: [1 %, 2 %]
  - random:
      count: {count}
      axes:
        speed: [400 rpm, 450 rpm]
        sensors.cylinder_pressure.range: {{uniform: [1 MPa, 2 MPa]}}
splits: {{train: {train} %, test: {} %}}
", 100 - train);
        let plan = plan(&text).unwrap();
        let mut split_of = BTreeMap::new();
        let mut group_of = BTreeMap::new();
        for case in all(&plan, |case| case) {
            let before = split_of.insert(case.group, case.split);
            prop_assert!(before.is_none_or(|split| split == case.split));
            let physics = (tenths(&case).map(f64::to_bits), case.resolved.speed.to_bits());
            let before = group_of.insert(physics, case.group);
            prop_assert!(before.is_none_or(|group| group == case.group));
        }
        prop_assert_eq!(split_of.len(), group_of.len());
        let shorter = text.replace("repeats:", "shard_size: 3\nrepeats:");
        prop_assert_eq!(Plan::shards(&self::plan(&shorter).unwrap()), plan.cases().div_ceil(3));
    }
}

#[test]
fn effects_of_the_catalogue_vary() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = root().join("data/machines/single-stage.yaml");
    let machine = std::fs::read_to_string(shipped).unwrap();
    let (machine, _) = machine.split_once("effects:").unwrap();
    let effects = "\
effects:
  - ring_friction: {coulomb_force: 10 N}
  - extra_clearance: {joint: small_end, clearance: 0.1 mm}
";
    let path = folder.path().join("machine.yaml");
    std::fs::write(&path, format!("{machine}{effects}")).unwrap();
    let text = "\
name: test
machine: machine.yaml
run: {revolutions: 4, transient: 2}
cases:
  - grid:
      effects.ring_friction.coulomb_force: [0 N, 100 N]
      effects.extra_clearance.clearance: [0.1 mm, 0.2 mm]
";
    let document = Document::parse(text, "sweep.yaml").unwrap();
    let plan = Plan::new(&document, folder.path()).unwrap();
    let columns: Vec<&str> = plan.parameters.iter().map(|p| p.column.as_str()).collect();
    assert_eq!(
        columns,
        [
            "effects.ring_friction.coulomb_force_n",
            "effects.extra_clearance.clearance_m"
        ]
    );
    let found = all(&plan, |case| {
        let machine = &case.resolved.machine;
        let clearance = machine.throws[0].small_end.clear().unwrap().clearance;
        // The label says what the joint really has.
        assert_eq!(case.labels.clearances_m[2], clearance);
        (machine.effects.len(), (clearance * 1e6).round())
    });
    let expected = [(0, 100.0), (0, 200.0), (1, 100.0), (1, 200.0)];
    let found: BTreeSet<String> = found.iter().map(|f| format!("{f:?}")).collect();
    assert_eq!(found, expected.iter().map(|e| format!("{e:?}")).collect());
}
