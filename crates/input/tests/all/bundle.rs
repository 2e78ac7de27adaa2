//! recordings.yaml: what is read, and what wrong files get.

use input::bundle::{Bundle, Joint};
use std::path::Path;

fn read(text: &str) -> Result<Bundle, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("recordings.yaml"), text).unwrap();
    let bundle = Bundle::read(folder.path());
    let prefix = format!("{}/", folder.path().display());
    bundle.map_err(|error| error.to_string().replace(&prefix, ""))
}

const TWO_THROWS: &str = "
format: clearance recordings 1
machine:
  crank: {driven: free}
  throws: [{name: throw1}, {name: throw2}]
runs:
- id: a
  file: a.parquet
  speed_rpm: 495.9
  speed_reference_rpm: 496
  load:
    throw1: {suction_pressure_pa: 1.0e5, discharge_pressure_pa: 2.8e5}
    throw2: {suction_pressure_pa: 2.7e5, discharge_pressure_pa: 1.3e6}
  joints:
    throw1: {big_end: {clearance_m: 1.0e-4}}
    throw2: {big_end: ideal}
  sample_rate_hz: 20000.0
  samples: 72581
  revolutions: 30
  channels:
  - {name: time, column: t_s, unit: s}
";

#[test]
fn throws_keep_their_names() {
    let bundle = read(TWO_THROWS).unwrap();
    assert_eq!(bundle.machine["throws"][1]["name"], "throw2");
    let run = &bundle.runs[0];
    assert_eq!(run.load["throw2"].discharge_pressure_pa.get(), 1.3e6);
    assert!(
        matches!(&run.joints["throw1"]["big_end"], Joint::Section(c) if c.clearance_m.get() == 1e-4)
    );
    assert!(matches!(&run.joints["throw2"]["big_end"], Joint::Scalar(_)));
    assert_eq!(run.speed_reference_rpm.unwrap().get(), 496.0);
    assert_eq!(run.samples, Some(72_581));
    assert_eq!(bundle.path_of(run), Ok(bundle.folder.join("a.parquet")));
    assert!(Bundle::is_at(Path::new("x/recordings.yaml")));
}

#[test]
fn throws_keep_their_names_where_the_machine_stands_elsewhere() {
    let machine = "machine:\n  crank: {driven: free}\n  throws: [{name: throw1}, {name: throw2}]\n";
    for other in ["", "machine: {name: press}\n"] {
        let bundle = read(&TWO_THROWS.replace(machine, other)).unwrap();
        let run = &bundle.runs[0];
        assert_eq!(run.load["throw2"].discharge_pressure_pa.get(), 1.3e6);
        assert!(matches!(&run.joints["throw2"]["big_end"], Joint::Scalar(_)));
    }
}

#[test]
fn a_bundle_needs_little() {
    let text = "runs:\n- {id: a, file: a.csv, channels: [{column: p, unit: Pa}]}\n";
    let bundle = read(text).unwrap();
    assert!(bundle.machine.is_null());
    assert!(bundle.runs[0].speed_rpm.is_none() && bundle.runs[0].load.is_empty());
}

#[test]
fn mistakes_are_named_with_their_line() {
    let one = "runs:\n- id: a\n  file: a.csv\n  channels: [{column: p, unit: Pa}]\n";
    for (text, expected) in [
        (
            "runs: []\n".to_owned(),
            "recordings.yaml:1:7: runs: found an empty list, expected a list of one run or more",
        ),
        ("machine: {}\n".to_owned(), "runs: missing"),
        (
            format!("format: foo\n{one}"),
            ":1:9: format: found 'foo', expected 'clearance recordings 1'",
        ),
        (
            format!("{one}  speed_rpm: -3\n"),
            ":5:14: runs.0.speed_rpm: found -3, expected a plain number greater than 0",
        ),
        (
            format!("{one}  sampels: 3\n"),
            ":5:3: runs.0.sampels: unknown key",
        ),
        (
            format!("{one}  load: {{suction_pressure_pa: 1}}\n"),
            "runs.0.load.discharge_pressure_pa: missing",
        ),
        (
            format!("{one}  joints: {{big_end: wide}}\n"),
            ":5:21: runs.0.joints.big_end: found 'wide', expected 'ideal' or a section",
        ),
        (
            format!("{one}- {{id: a, file: b.csv, channels: [{{column: p, unit: Pa}}]}}\n"),
            ":5:8: runs.1.id: found 'a', expected an id of its own for every run",
        ),
        (
            one.replace("[{column: p, unit: Pa}]", "[]"),
            "expected a list of one channel or more",
        ),
        (
            one.replace(", unit: Pa", ""),
            "runs.0.channels.0.unit: missing",
        ),
    ] {
        let message = read(&text).unwrap_err();
        assert!(message.contains(expected), "{message}\n  not {expected}");
    }
    // A key from a later version of the format.
    assert!(read(&format!("{one}  humidity: 3\n")).is_ok());
}
