//! Sweep files become cases.

use input::yaml::Document;
use std::path::{Path, PathBuf};
use std::time::Instant;
use sweep::Plan;

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

#[test]
fn bearing_faults_stay_in_their_ranges() {
    let plan = shipped("bearing-faults.yaml");
    assert_eq!(plan.cases(), 2048);
    let mut faults = std::collections::BTreeMap::new();
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

#[test]
fn a_case_is_planned_in_a_fraction_of_a_millisecond() {
    let plan = shipped("bearing-faults.yaml");
    let start = Instant::now();
    for i in 0..500 {
        plan.case(i).unwrap();
    }
    let mean = start.elapsed() / 500;
    println!("{mean:?} a case");
    // Measured: see the report; this catches only a change of kind.
    assert!(mean.as_millis() < 20, "{mean:?}");
}
