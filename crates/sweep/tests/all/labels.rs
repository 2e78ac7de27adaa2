//! Labels: healthy joints, effects as faults, splits stratified by label, and what is warned of.

use input::yaml::Document;
use recordings::Role;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use sweep::dataset::Tables;
use sweep::{Case, Plan};

/// The single-stage machine with `changed` text, in a folder of its own, and a sweep of it.
fn plan_of(machine: &str, changes: &[(&str, &str)], rest: &str) -> Plan {
    tried(machine, changes, rest).unwrap_or_else(|error| panic!("{error}"))
}

/// The same, or what is wrong with it.
fn tried(machine: &str, changes: &[(&str, &str)], rest: &str) -> Result<Plan, input::Error> {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    let mut text = std::fs::read_to_string(shipped.join(machine)).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("machine.yaml"), text).unwrap();
    let sweep =
        format!("name: test\nmachine: machine.yaml\nrun: {{revolutions: 4, transient: 2}}\n{rest}");
    let document = Document::parse(&sweep, "sweep.yaml").unwrap();
    Plan::new(&document, folder.path())
}

fn cases(plan: &Plan) -> Vec<Case> {
    (0..plan.cases()).map(|i| plan.case(i).unwrap()).collect()
}

fn faults(plan: &Plan) -> Vec<String> {
    let cases = cases(plan).into_iter();
    cases.map(|case| case.labels.fault).collect()
}

/// Names of the columns with the role of a label that hold the size of an effect.
fn sizes(plan: &Plan) -> Vec<String> {
    let columns = Tables::new(plan).unwrap().features;
    let columns = columns.columns().iter();
    columns
        .filter(|c| c.role == Some(Role::Label) && c.name.starts_with("effects."))
        .map(|c| c.name.clone())
        .collect()
}

/// Every joint with a clearance of its own, and no normal one.
const WORN_IN: [(&str, &str); 5] = [
    ("clearance: ideal ", "clearance: 0.03 mm "),
    ("clearance: ideal\n", "clearance: 0.03 mm\n"),
    ("    normal_clearance: 0.04 mm       # assumed here\n", ""),
    ("    normal_clearance: 0.03 mm       # assumed here\n", ""),
    ("    normal_clearance: 0.05 mm       # assumed here\n", ""),
];

#[test]
fn a_joints_own_clearance_is_normal_where_the_machine_file_states_none() {
    let rest = "cases:
  - grid: {joints: [[], [big_end]], clearance: [0.02 mm, 30 um, 0.1 mm], speed: [400 rpm, 500 rpm]}
";
    let plan = plan_of("single-stage.yaml", &WORN_IN, rest);
    let expected = [
        "none", "none", "none", "none", "none", "none", "big_end", "big_end",
    ];
    assert_eq!(faults(&plan), expected);
    assert_eq!(cases(&plan)[6].labels.faulty_joints, 1);
    // Each joint stays at its own clearance where a case sets none.
    assert_eq!(cases(&plan)[0].labels.clearances_m, [3e-5; 4]);
}

#[test]
fn a_clearance_that_follows_the_speed_is_no_fault() {
    let mut machine = WORN_IN.to_vec();
    machine.push((
        "effects: []",
        "effects: [{thermal_clearance: {joint: big_end, change: 10 um}}]",
    ));
    let rest = "cases:
  - grid: {joints: [[], [big_end]], clearance: 0.1 mm, speed: [400 rpm, 600 rpm]}
";
    let plan = plan_of("single-stage.yaml", &machine, rest);
    assert_eq!(faults(&plan), ["none", "none", "big_end", "big_end"]);
    let warm = cases(&plan)[1].labels.clearances_m[1];
    assert!((warm - 4.2e-5).abs() < 1e-9, "{warm}");
}

#[test]
fn a_clearance_that_is_known_with_an_uncertainty_is_no_fault() {
    let rest = "cases: [{grid: {joints: [[], [big_end]], clearance: 0.1 mm, speed: {from: 400 rpm, to: 500 rpm, count: 8}}}]
vary_together:
  - parameters: {joints.small_end.clearance: {lognormal: {factor: 1.1}}}
    correlations: [[1]]
";
    let plan = plan_of("single-stage.yaml", &WORN_IN, rest);
    let expected = [["none"; 8], ["big_end"; 8]].concat();
    assert_eq!(faults(&plan), expected);
    let drawn = |case: &Case| case.labels.clearances_m[2].to_bits();
    let drawn: BTreeSet<u64> = cases(&plan).iter().map(drawn).collect();
    assert_eq!(drawn.len(), 16);
}

#[test]
fn joints_that_are_faulty_unasked_and_a_single_label_are_warned_of() {
    // The guide's clearance is above what the file calls normal.
    let worn = (
        "    clearance: ideal\n    normal_clearance: 0.05 mm",
        "    clearance: 0.1 mm\n    normal_clearance: 0.05 mm",
    );
    let rest =
        "cases: [{grid: {joints: [[], [guide]], clearance: 0.2 mm, speed: [400 rpm, 500 rpm]}}]
";
    let plan = plan_of("single-stage.yaml", &[worn], rest);
    assert_eq!(faults(&plan), ["guide"; 4]);
    let warnings = plan.census().warnings();
    assert!(
        warnings[0].starts_with("all 4 cases have the label guide"),
        "{warnings:?}"
    );
    let expected = "guide is faulty in 2 cases whose `joints` do not name it (case-000000: a \
                    clearance of 0.1000 mm): joints.guide.normal_clearance in the machine file must \
                    be at least joints.guide.clearance where the joint is healthy";
    assert_eq!(warnings[1], expected);
    // A sweep without mistakes has no warning but for its size.
    let fine = plan_of(
        "single-stage.yaml",
        &[],
        "cases: [{grid: {joints: [[], [guide]], clearance: 0.2 mm, speed: {from: 400 rpm, to: 500 rpm, count: 20}}}]",
    );
    assert!(fine.census().warnings().is_empty());
}

#[test]
fn splits_are_stratified_by_label_where_there_is_room() {
    // 3 healthy cases of 21: they had none in validation and test with most seeds.
    for seed in 0..10 {
        let rest = format!(
            "seed: {seed}
cases:
  - grid: {{joints: [[]], speed: [400 rpm, 450 rpm, 500 rpm]}}
  - grid: {{joints: [[big_end], [small_end]], clearance: [0.1 mm, 0.2 mm, 0.3 mm], speed: [400 rpm, 450 rpm, 500 rpm]}}
"
        );
        let plan = plan_of("single-stage.yaml", &[], &rest);
        let census = plan.census();
        let count = |label| -> Vec<u64> { census.cases(label).into_values().collect() };
        // By the names of the splits: test, train, validation.
        assert_eq!(count("none"), [1, 1, 1], "seed {seed}");
        let sums = |i: usize| {
            let labels = ["none", "big_end", "small_end"];
            labels.iter().map(|label| count(label)[i]).sum::<u64>()
        };
        assert_eq!([sums(0), sums(1), sums(2)], [3, 15, 3], "seed {seed}");
        assert!(census.warnings().is_empty());
        // The cases are where the census has them, whatever the shards.
        let of_validation = |plan: &Plan| -> Vec<u64> {
            let all = cases(plan).into_iter();
            let own = all.filter(|case| case.split.name() == "validation");
            own.map(|case| case.index).collect()
        };
        assert_eq!(of_validation(&plan).len(), 3);
        let other = plan.clone().with_shards(5).unwrap();
        assert_eq!(of_validation(&other), of_validation(&plan));
    }
}

#[test]
fn a_label_that_a_split_lacks_is_warned_of() {
    let rest = "splits: {train: 50 %, test: 50 %}
cases:
  - grid: {joints: [[]]}
  - grid: {joints: [[big_end]], clearance: [0.1 mm, 0.2 mm, 0.3 mm]}
";
    let census = plan_of("single-stage.yaml", &[], rest);
    let census = census.census();
    let lacking: Vec<&str> = census
        .cases("none")
        .into_iter()
        .filter_map(|(split, count)| (count == 0).then_some(split))
        .collect();
    let expected = format!(
        "the split {} has no case of 1 of 2 labels (none): more cases of a label, or a larger share \
         of the split, give it some",
        lacking[0]
    );
    assert_eq!(census.warnings(), [expected]);
    let table = census.to_string();
    let lines: Vec<Vec<&str>> = table
        .lines()
        .map(|l| l.split_whitespace().collect())
        .collect();
    assert_eq!(lines[1], ["label", "train", "test", "all"]);
    assert_eq!(lines[2][3], "1");
    assert_eq!(lines[3][3], "3");
    assert_eq!(lines[4], ["all", "2", "2", "4"]);
}

#[test]
fn an_effect_that_the_sweep_varies_is_a_label_with_its_size() {
    let leak = [(
        "effects: []",
        "effects: [{ring_leakage: {area: 0 mm^2}}, {valve_loss: {suction: 0.1, discharge: 0.1}}]",
    )];
    let rest = "cases:
  - grid: {joints: [[], [big_end]], clearance: 0.1 mm, effects.ring_leakage.area: [0 mm^2, 3 mm^2]}
";
    let plan = plan_of("single-stage.yaml", &leak, rest);
    // The loss of the valves is part of the machine.
    assert_eq!(
        faults(&plan),
        ["none", "ring_leakage", "big_end", "big_end+ring_leakage"]
    );
    assert_eq!(cases(&plan)[3].labels.faulty_joints, 1);
    assert_eq!(sizes(&plan), ["effects.ring_leakage.area_m2"]);
    // By its index, and in a second block alone.
    let rest = "cases:
  - grid: {speed: [400 rpm, 500 rpm]}
  - grid: {effects.0.ring_leakage.area: 3 mm^2}
";
    let plan = plan_of("single-stage.yaml", &leak, rest);
    assert_eq!(faults(&plan), ["none", "none", "ring_leakage"]);
    // Of an effect with several amplitudes each is a column, also those that do not vary.
    let rest = "cases: [{grid: {effects.valve_loss.discharge: [0, 0.2]}}]";
    let both = [(
        "effects: []",
        "effects: [{valve_loss: {suction: 0, discharge: 0}}]",
    )];
    let plan = plan_of("single-stage.yaml", &both, rest);
    assert_eq!(faults(&plan), ["none", "valve_loss"]);
    assert_eq!(sizes(&plan), ["effects.valve_loss.discharge"]);
    let plan = plan_of("single-stage.yaml", &leak, rest);
    assert_eq!(faults(&plan), ["valve_loss", "valve_loss"]);
    assert_eq!(
        sizes(&plan),
        ["effects.valve_loss.discharge", "effects.valve_loss.suction"]
    );
    // What is no amplitude is no label.
    let hum = [(
        "effects: []",
        "effects: [{mains_hum: {amplitude: 5 m/s^2}}]",
    )];
    let rest = "cases: [{grid: {effects.mains_hum.frequency: [50 Hz, 60 Hz]}}]";
    let plan = plan_of("single-stage.yaml", &hum, rest);
    assert_eq!(faults(&plan), ["none", "none"]);
    assert_eq!(plan.parameters[0].role, Role::Condition);
    // Every value of an effect that is a label gives it away.
    let rest = "cases: [{random: {count: 4, axes: {
  effects.valve_flutter.suction: {uniform: [3 %, 20 %]}, effects.valve_flutter.frequency: {uniform: [60 Hz, 250 Hz]}}}}]";
    let plan = plan_of("single-stage.yaml", &[], rest);
    let roles = plan.parameters.iter().map(|parameter| parameter.role);
    assert!(roles.eq([Role::Label; 2]), "{:?}", plan.parameters);
}

#[test]
fn an_effect_that_a_case_names_and_the_machine_lacks_is_absent_elsewhere() {
    let rest = "cases:
  - grid: {speed: [400 rpm, 500 rpm]}
  - grid: {effects.ring_leakage.area: [2 mm^2, 3 mm^2]}
  - grid: {effects.valve_leakage.suction: 4 mm^2, effects.sensor_gain.error: 10 %}
";
    let plan = plan_of("single-stage.yaml", &[], rest);
    let expected = [
        "none",
        "none",
        "ring_leakage",
        "ring_leakage",
        "sensor_gain+valve_leakage",
    ];
    assert_eq!(faults(&plan), expected);
    let columns = [
        "effects.ring_leakage.area_m2",
        "effects.valve_leakage.suction_m2",
        "effects.sensor_gain.error",
    ];
    assert_eq!(sizes(&plan), columns);
    // Written out, it is the same sweep.
    let written = input::yaml::to_string(plan.sweep()).unwrap();
    let document = Document::parse(&written, "sweep.yaml").unwrap();
    assert_eq!(Plan::new(&document, Path::new("")).unwrap().id, plan.id);
    // A bearing has to be named.
    let oval = "name: test
machine: single-stage.yaml
run: {revolutions: 4, transient: 2}
cases: [{grid: {effects.bearing_ovality.amplitude: 10 um}}]
";
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    let document = Document::parse(oval, "sweep.yaml").unwrap();
    let message = Plan::new(&document, &machines).unwrap_err().to_string();
    let expected = "effects.bearing_ovality.amplitude: found an effect that the machine file does not list, expected it in \
                    the list effects of the machine file, e.g. '- bearing_ovality: {joint: main, amplitude: 3e-5 m}'";
    assert!(message.contains(expected), "{message}");
}

#[test]
fn whole_lists_of_effects_are_labels_too() {
    let rest = "cases:
  - grid:
      effects:
        - []
        - [{ring_leakage: {area: 3 mm^2}}]
        - [{squeeze_film: {joint: big_end, viscosity: 0.1 Pa s}}, {ring_leakage: {area: 1 mm^2}}]
";
    let plan = plan_of("single-stage.yaml", &WORN_IN, rest);
    assert_eq!(
        faults(&plan),
        ["none", "ring_leakage", "ring_leakage+squeeze_film"]
    );
    let area = plan
        .parameters
        .iter()
        .position(|p| p.path == "effects.ring_leakage.area");
    assert!(area.is_some(), "{:?}", plan.parameters);
    let column = "effects.ring_leakage.area_m2".to_owned();
    assert!(sizes(&plan).contains(&column), "{:?}", sizes(&plan));
}

#[test]
fn an_effect_is_no_label_where_its_joint_is_ideal() {
    let film = [(
        "effects: []",
        "effects: [{squeeze_film: {joint: small_end, viscosity: 0 Pa s}}]",
    )];
    let rest = "cases:
  - grid: {joints: [[], [small_end]], clearance: 0.1 mm, effects.squeeze_film.viscosity: [0 Pa s, 0.02 Pa s]}
";
    let plan = plan_of("single-stage.yaml", &film, rest);
    let expected = ["none", "none", "small_end", "small_end+squeeze_film"];
    assert_eq!(faults(&plan), expected);
    let cases = cases(&plan);
    assert_eq!(cases[0].group, cases[1].group);
    assert_ne!(cases[2].group, cases[3].group);
    let viscosity = |case: &Case| plan.parameters[0].value(&case.tree);
    assert_eq!(viscosity(&cases[0]), viscosity(&cases[1]));
    // More clearance makes the joint clear.
    let thermal = [(
        "effects: []",
        "effects: [{extra_clearance: {joint: big_end, clearance: 0 um}}, {thermal_clearance: {joint: big_end, change: 0 um}}]",
    )];
    let rest = "cases:
  - grid: {effects.extra_clearance.clearance: [0 um, 90 um], effects.thermal_clearance.change: [0 um, 5 um]}
";
    let expected = [
        "none",
        "none",
        "big_end+extra_clearance",
        "big_end+extra_clearance+thermal_clearance",
    ];
    assert_eq!(
        faults(&plan_of("single-stage.yaml", &thermal, rest)),
        expected
    );
}

#[test]
fn an_effect_that_acts_in_no_case_is_refused() {
    for effect in [
        "squeeze_film: {joint: big_end, viscosity: 0 Pa s}",
        "bearing_ovality: {joint: big_end, amplitude: 0 um}",
        "thermal_clearance: {joint: big_end, change: 0 um}",
    ] {
        let (name, _) = effect.split_once(':').unwrap();
        let list = format!("effects: [{{{effect}}}]");
        let key = match name {
            "squeeze_film" => "viscosity: [0 Pa s, 0.02 Pa s]",
            "bearing_ovality" => "amplitude: [0 um, 10 um]",
            _ => "change: [0 um, 50 um]",
        };
        let rest = format!(
            "cases: [{{grid: {{joints: [[], [small_end]], clearance: 0.1 mm, effects.{name}.{key}}}}}]"
        );
        let error = tried("single-stage.yaml", &[("effects: []", &list)], &rest).unwrap_err();
        let message = error.to_string();
        let (key, _) = key.split_once(':').unwrap();
        let expected = format!(
            "effects.{name}.{key}.0: found {name}, which acts on big_end, expected a clearance of big_end"
        );
        assert!(message.contains(&expected), "{message}");
        assert!(message.starts_with("sweep.yaml:4:"), "{message}");
    }
}

#[test]
fn a_chamber_that_the_cylinder_lacks_is_refused_at_the_effect() {
    for (effect, key) in [
        (
            "ring_leakage: {end: crank, area: 0 mm^2}",
            "ring_leakage.area",
        ),
        (
            "valve_leakage: {end: crank, suction: 0 mm^2, discharge: 0 mm^2}",
            "valve_leakage.suction",
        ),
    ] {
        let list = format!("effects: [{{{effect}}}]");
        let rest = format!("cases: [{{grid: {{effects.{key}: [0 mm^2, 5 mm^2]}}}}]");
        let error = tried("single-stage.yaml", &[("effects: []", &list)], &rest).unwrap_err();
        let message = error.to_string();
        let (name, _) = key.split_once('.').unwrap();
        let expected = format!("effects.0.{name}.end: found 'crank', expected head");
        assert!(message.contains(&expected), "{message}");
        assert!(message.contains("machine.yaml:"), "{message}");
    }
}

#[test]
fn effects_of_one_throw_have_its_name() {
    let leak = [(
        "effects: []",
        "effects: [{ring_leakage: {throw: throw2, area: 0 mm^2}}, {heat_transfer: {stanton: 0}}]",
    )];
    let rest = "cases: [{zip: {effects.ring_leakage.area: [0 mm^2, 3 mm^2, 3 mm^2], effects.heat_transfer.stanton: [0, 0, 0.01]}}]";
    let plan = plan_of("two-stage.yaml", &leak, rest);
    assert_eq!(
        faults(&plan),
        [
            "none",
            "throw2.ring_leakage",
            "heat_transfer+throw2.ring_leakage"
        ]
    );
}

#[test]
fn an_effect_that_the_sweep_puts_on_one_throw_has_a_column_of_its_own() {
    let rest = "cases: [{grid: {effects.ring_leakage.throw: [throw2], effects.ring_leakage.area: [0 mm^2, 2 mm^2]}}]";
    let plan = plan_of("two-stage.yaml", &[], rest);
    assert_eq!(faults(&plan), ["none", "throw2.ring_leakage"]);
    let columns = [
        "effects.ring_leakage.throw",
        "effects.ring_leakage.area_m2",
        "effects.ring_leakage.throw2.area_m2",
    ];
    assert_eq!(sizes(&plan), columns);
}

#[test]
fn the_crank_end_of_a_cylinder_is_not_the_crank() {
    let leak = [(
        "effects: []",
        "effects: [{ring_leakage: {throw: throw1, end: crank, area: 0 mm^2}}]",
    )];
    let rest = "cases: [{grid: {effects.ring_leakage.area: [0 mm^2, 3 mm^2]}}]";
    let plan = plan_of("two-stage.yaml", &leak, rest);
    let places: Vec<String> = (cases(&plan)[1].labels.faults.iter())
        .map(|fault| fault.location.clone())
        .collect();
    assert_eq!(places, ["throw1.crank_end"]);
}

#[test]
fn whole_numbers_may_have_a_point() {
    let rest = "repeats: 2.0\nseed: 1e3\ncases: [{grid: {speed: 400 rpm}}]";
    let plan = plan_of("single-stage.yaml", &[], rest);
    assert_eq!((plan.cases(), plan.seed), (2, 1000));
}

#[test]
fn what_is_drawn_about_an_effect_of_the_machine_is_an_unknown() {
    let lossy = [(
        "effects: []",
        "effects: [{valve_loss: {suction: 0.1, discharge: 0.1}}]",
    )];
    let rest = "cases: [{grid: {speed: [400 rpm, 500 rpm]}}]
vary: {effects.valve_loss.discharge: {lognormal: {factor: 1.2}}}
";
    let plan = plan_of("single-stage.yaml", &lossy, rest);
    assert_eq!(faults(&plan), ["none", "none"]);
    assert_eq!(plan.parameters[0].role, Role::Unknown);
    // Drawn among values without it, it is a fault.
    let rest = "cases: [{grid: {speed: {from: 400 rpm, to: 500 rpm, count: 40}}}]
vary: {effects.valve_loss: [{suction: 0, discharge: 0}, {suction: 0.1, discharge: 0.2}]}
";
    let plan = plan_of("single-stage.yaml", &lossy, rest);
    let found: BTreeSet<String> = faults(&plan).into_iter().collect();
    assert_eq!(found, ["none", "valve_loss"].map(String::from).into());
}

#[test]
fn cases_that_differ_in_the_sensors_effects_stay_together() {
    let gain = [("effects: []", "effects: [{sensor_gain: {error: 0 %}}]")];
    let rest = "cases: [{grid: {speed: {from: 400 rpm, to: 500 rpm, count: 20}, effects.sensor_gain.error: [0 %, 5 %, -5 %]}}]";
    let plan = plan_of("single-stage.yaml", &gain, rest);
    let mut splits: BTreeMap<u64, BTreeSet<&str>> = BTreeMap::new();
    for case in cases(&plan) {
        splits
            .entry(case.group)
            .or_default()
            .insert(case.split.name());
    }
    assert_eq!(splits.len(), 20);
    assert!(splits.values().all(|names| names.len() == 1));
    // Three of 20 groups in validation and in test, each with one case of none and two of the gain.
    let counts: Vec<u64> = plan.census().cases("sensor_gain").into_values().collect();
    assert_eq!(counts, [6, 28, 6]);
}

#[test]
fn one_machine_is_one_group_however_its_values_are_written() {
    let rest = "cases:
  - grid: {joints: [[], [big_end], [small_end]], clearance: {from: 0.1 mm, to: 0.3 mm, count: 3}, speed: 500 rpm}
  - grid: {joints: [[], [big_end], [small_end]], clearance: [0.1 mm, 200 um, 0.3 mm], speed: 52.35987755982989 rad/s}
";
    let cases = cases(&plan_of("single-stage.yaml", &[], rest));
    let (first, second) = cases.split_at(cases.len() / 2);
    for (one, other) in first.iter().zip(second) {
        assert_eq!(one.group, other.group, "{}", one.id);
        assert_eq!(one.split, other.split, "{}", one.id);
    }
    let groups: BTreeSet<u64> = first.iter().map(|case| case.group).collect();
    assert_eq!(groups.len(), 7);
    // Steps are the decimals that a list would have.
    assert_eq!(first[2].labels.clearances_m[1], 2e-4);
}

#[test]
fn columns_have_roles() {
    let rest = "cases: [{grid: {joints: [[], [big_end]], clearance: 0.1 mm, crosshead.mass: [18 kg, 19 kg]}}]
vary: {joints.big_end.contact.damping: {lognormal: {factor: 1.5}}}
";
    let plan = plan_of("single-stage.yaml", &[], rest);
    let tables = Tables::new(&plan).unwrap();
    let role = |schema: &recordings::Schema, name: &str| {
        let column = &schema.columns()[schema.position(name).unwrap()];
        column.role.map(Role::name)
    };
    let signals = |name| role(&tables.signals, name);
    assert_eq!(signals("case_id"), Some("identifier"));
    assert_eq!(signals("split"), Some("identifier"));
    for label in [
        "fault",
        "fault_type",
        "faulty_joints",
        "clearance_big_end_m",
    ] {
        assert_eq!(signals(label), Some("label"), "{label}");
    }
    for condition in ["speed_rpm", "discharge_pressure_pa", "crosshead.mass_kg"] {
        assert_eq!(signals(condition), Some("condition"), "{condition}");
    }
    assert_eq!(
        signals("joints.big_end.contact.damping_n_s_m"),
        Some("unknown")
    );
    assert_eq!(signals("crosshead_acceleration_m_s2"), Some("signal"));
    let rms = "crosshead_acceleration.rms_m_s2";
    assert_eq!(role(&tables.features, rms), Some("feature"));
    assert_eq!(role(&tables.features, "fault"), Some("label"));
}
