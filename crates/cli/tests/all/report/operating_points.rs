//! Pages of machines with several throws and sensors, at several speeds and settings of the contacts.

use super::{Dataset, GRID, single_stage, stands_alone};
use report::dataset_page::Design;
use std::fs;
use sweep::dataset::Existing;
use sweep::sweep_file::Format;

/// The machine of the tests with other throws and sensors, and a sweep of it.
fn with_sensors(throws: &str, sensors: &str, sweep: &str) -> Dataset {
    let folder = tempfile::tempdir().unwrap();
    let machine = fs::read_to_string(single_stage()).unwrap();
    let (head, _) = machine.split_once("\nsensors:").unwrap();
    let head = head.replace("\njoints:", &format!("\n{throws}\njoints:"));
    let sensors = format!("\nsensors:\n{sensors}");
    fs::write(folder.path().join("machine.yaml"), head + &sensors).unwrap();
    let text = format!("name: small\nmachine: machine.yaml\nseed: 5{sweep}");
    fs::write(folder.path().join("small.yaml"), text).unwrap();
    let dataset = Dataset { folder };
    dataset.generate(Format::Parquet, Existing::Refuse);
    dataset
}

/// Faults of either throw, each judged by the sensor of its own; at the other throw's there is
/// nothing to see of them.
#[test]
fn a_fault_is_judged_by_the_sensor_of_its_own_throw() {
    let sweep = GRID.replace("study: paper2\n", "").replace(
        "joints: [[], [big_end], [big_end, small_end]]",
        "joints: [[], [front.small_end], [rear.small_end], [front.small_end, rear.small_end]]",
    );
    let throws = "throws: [{name: front}, {name: rear}]";
    let sensors = "
  - {measure: crosshead_acceleration, throw: front}
  - {measure: crosshead_acceleration, throw: rear}
";
    let dataset = with_sensors(throws, sensors, &sweep);
    let output = dataset.report(&[]);
    assert!(output.status.success());
    let html = dataset.html();
    stands_alone(&html);
    assert!(html.contains("front: front.crosshead_acceleration_m_s2; rear: rear.crosshead_"));
    assert!(html.contains("No sensor reads the crank angle"));
    let page = dataset.page();
    let Design::Grid(grids) = &page.design else {
        panic!("a grid")
    };
    let sensors: Vec<&str> = grids.grids.iter().map(|g| g.sensor.as_str()).collect();
    assert_eq!(
        sensors,
        [
            "front.crosshead acceleration",
            "rear.crosshead acceleration"
        ]
    );
    for (grid, own) in grids
        .grids
        .iter()
        .zip(["front.small_end", "rear.small_end"])
    {
        let sets: Vec<&str> = grid
            .joint_sets
            .iter()
            .map(|set| set.joints.as_str())
            .collect();
        assert_eq!(sets, [own, "front.small_end+rear.small_end"]);
        // Speed given, the throws are alike and do not know of one another: a fault of this throw is
        // as large as the fault of both, and larger than none.
        let peak = |at: usize| grid.levels[at].peak;
        assert_eq!(grid.levels[0].joints, "none");
        assert!(peak(2).value > 1.2 * peak(0).value, "{:?}", grid.levels);
        assert!(peak(2).against(peak(4)).is_eq());
    }
    // Features by class: two rows of the healthy, one of each fault of one throw.
    let rows = page
        .feature_rows
        .iter()
        .map(|row| (row.fault.as_str(), row.sensor.as_str()));
    let (front, rear) = (
        "front.crosshead_acceleration",
        "rear.crosshead_acceleration",
    );
    let both = "front.small_end+rear.small_end";
    assert_eq!(
        rows.collect::<Vec<_>>(),
        [
            ("none", front),
            ("none", rear),
            ("front.small_end", front),
            ("rear.small_end", rear),
            (both, front),
            (both, rear)
        ]
    );
    // Of a machine that repeats no study nothing is claimed.
    assert!(
        !html.contains("study") && !String::from_utf8(output.stdout).unwrap().contains("claim")
    );
}

#[test]
fn a_machine_with_a_frame_sensor_alone_has_figures() {
    let sensors = "
  - {measure: frame_acceleration, axis: x}
  - {measure: crank_angle}
";
    let dataset = with_sensors("", sensors, GRID);
    assert!(dataset.report(&[]).status.success());
    let html = dataset.html();
    assert!(html.contains("Figures show the channel frame_acceleration_x_m_s2"));
    assert_eq!(html.matches("<figcaption>").count(), 3 + 2 + 1 + 2 + 1);
    let chaos = fs::read_to_string(dataset.path().join("chaos.html")).unwrap();
    assert!(!chaos.contains("There are no recordings in tables"));
}

/// Two speeds: both are on the page, and what they differ in stands above them.
#[test]
fn every_operating_point_is_on_the_page() {
    let sweep = GRID.replace("[500 rpm]", "[500 rpm, 400 rpm]");
    let dataset = Dataset::with_sweep(&sweep, Format::Parquet);
    let output = dataset.report(&[]);
    assert!(output.status.success());
    let html = dataset.html();
    stands_alone(&html);
    for speed in ["500", "400"] {
        assert!(
            html.contains(&format!("<h2>Responses: {speed}\u{a0}rpm, discharge")),
            "{speed}"
        );
        assert!(
            html.contains(&format!("<summary>{speed}\u{a0}rpm, discharge")),
            "{speed}"
        );
    }
    // And what goes with the speed, and the features that say most.
    assert_eq!(
        html.matches("<figcaption>").count(),
        3 + 2 * (2 + 1 + 2) + 2 + 1
    );
    // The claims have a row for each.
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("| 400 rpm | holds"), "{printed}");
}

/// A key of the joints is that of every joint that the sweep names, a stiffness by its formula too.
#[test]
fn settings_of_the_contacts_are_operating_points() {
    let sweep = GRID.replace(
        "speed: [500 rpm]",
        "contact.damping: [2e3 N s/m, 2e4 N s/m]
      contact.stiffness:
        - 24 GN/m^1.5
        - {from: eq5, youngs_modulus: 207 GPa, poisson_ratio: 0.3}",
    );
    let dataset = Dataset::with_sweep(&sweep, Format::Parquet);
    let page = dataset.page();
    let Design::Grid(grids) = &page.design else {
        panic!("a grid")
    };
    let settings: Vec<Vec<&str>> = grids
        .grids
        .iter()
        .map(|grid| {
            grid.settings
                .iter()
                .map(|(_, value)| value.as_str())
                .collect()
        })
        .collect();
    let formula = "from eq5, youngs modulus 207 GPa, poisson ratio 0.3";
    let (light, stiff) = ("2000\u{a0}N s/m", "24 GN/m^1.5");
    assert_eq!(settings[..2], [[light, stiff], [light, formula]]);
    assert_eq!(settings.len(), 4);
    assert_eq!(
        grids.grids[0].settings[0].0,
        "contact damping (big end, small end)"
    );
    for grid in &grids.grids {
        assert_eq!(grid.levels.len(), 5);
    }
}
