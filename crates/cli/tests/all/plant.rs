//! Plant data from file to features, wear and page, by the four commands of pipelines/README.md.

use crate::one_run::{crosshead, said};
use crate::readme;
use ::calibrate::wear::{Results, Verdict};
use std::fs;

/// The diametral clearance of the worn crosshead pin, m, and the crank angle of the pulse, rad: the folder's README.md.
const WORN: f64 = 0.012 * 0.0254;
const HEALTHY: f64 = 0.005 * 0.0254;
const PULSE: f64 = 137.0 / 180.0 * std::f64::consts::PI;

/// Runs a command that must succeed.
fn run(arguments: &[&str]) {
    let done = crosshead(arguments);
    assert!(done.status.success(), "{arguments:?}: {}", said(&done));
}

#[test]
fn a_worn_crosshead_pin_is_found_in_plant_data() {
    let clone = readme::clone();
    let tour = readme::section("pipelines/README.md", "Plant data");
    assert_eq!(readme::run(&tour, clone.path()), 4);
    assert!(clone.path().join("plant/features.parquet").is_file());

    let path = |name: &str| clone.path().join(name).to_str().unwrap().to_owned();
    let table = path("features.csv");
    let bundle = path("data/recordings/example-plant");
    run(&["features", &bundle, "--out", &table]);
    let features = fs::read_to_string(&table).unwrap();
    let rows: Vec<Vec<&str>> = features
        .lines()
        .map(|row| row.split(',').collect())
        .collect();
    let column = rows[0]
        .iter()
        .position(|name| name.ends_with("acceleration.peak_m_s2"));
    let peaks = rows[1..]
        .iter()
        .map(|row| row[column.unwrap()].parse::<f64>().unwrap());
    let peaks: Vec<f64> = peaks.collect();
    // Some g, read from a column in g.
    assert!(
        peaks.len() == 1 && peaks.iter().all(|peak| (20.0..100.0).contains(peak)),
        "{peaks:?}"
    );

    let results = Results::read(&clone.path().join("plant/wear/wear.json")).unwrap();
    assert_eq!(results.worn(), ["joints.small_end"]);
    for (joint, verdict, expected) in [
        ("joints.small_end", Verdict::Worn, WORN),
        ("joints.big_end", Verdict::Healthy, HEALTHY),
    ] {
        let found = results.joints.get(joint).unwrap();
        assert_eq!(found.verdict, verdict, "{joint}");
        let diametral = found.diametral_clearance_m.unwrap();
        assert!(
            (diametral / expected - 1.0).abs() < 1e-3,
            "{joint}: {diametral}"
        );
        let [low, high] = [found.low_m, found.high_m].map(|bound| 2.0 * bound.unwrap());
        assert!((low..high).contains(&expected), "{joint}: {low} to {high}");
    }
    assert_eq!(results.pulse_angles_rad.len(), 1);
    for (run, angle) in results.pulse_angles_rad.iter() {
        assert!((angle - PULSE).abs() < 5e-4, "{run}: {angle}");
    }

    let page = fs::read_to_string(clone.path().join("plant/wear/report.html")).unwrap();
    assert!(page.contains("Worn: small end."), "no verdict on the page");
    let pulse = format!("{:.1}\u{b0}</dd>", PULSE.to_degrees());
    assert!(page.contains(&pulse), "no place of the pulse on the page");
}
