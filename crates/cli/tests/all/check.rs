//! `crosshead check`: all mistakes of a file in one run, in the order of its lines.

use crate::small_sweep::{crosshead, text};
use std::path::Path;
use std::process::Output;

pub(crate) const MACHINE: &str = "\
name: small
speed: 740 rpm
crank:
  radius: 75 mm
rod:
  length: 400 mm
  mass: 12 kg
  centre_of_mass: 150 mm
  inertia: 0.3 kg m^2
crosshead:
  mass: 18 kg
cylinder:
  piston_radius: 50 mm
  suction: 1 bar
  discharge: 4 bar
  back: 1 bar
  exponent: 1.4
  head_clearance: 15 mm
joints:
  big_end:
    clearance: 0.1 mm
    journal_radius: 50 mm
    contact: {law: impact, stiffness: 24 GN/m^1.5, damping: 2e4 N s/m, depth: 10 um}
  small_end:
    clearance: 0.1 mm
    journal_radius: 35 mm
    contact: {law: impact, stiffness: 20 GN/m^1.5, damping: 2e4 N s/m, depth: 10 um}
sensors:
  - {measure: crosshead_acceleration, range: 50 g, bits: 16}
  - {measure: crank_angle}
effects:
  - valve_loss: {suction: 0.18}
";

pub(crate) const THROWS: &str = "\
name: two
speed: 740 rpm
crank: {radius: 75 mm}
rod: {length: 400 mm, mass: 12 kg, centre_of_mass: 150 mm, inertia: 0.3 kg m^2}
crosshead: {mass: 18 kg}
cylinder: {piston_radius: 50 mm, suction: 1 bar, discharge: 4 bar, back: 1 bar, exponent: 1.4, head_clearance: 15 mm}
throws:
  - {name: throw1}
  - {name: throw2, direction: opposed, crank_pin_angle: 180 deg}
sensors:
  - {measure: cylinder_pressure, throw: throw1}
  - {measure: cylinder_pressure, throw: throw2}
";

const SWEEP: &str = "\
name: small
machine: machine.yaml
seed: 1
run: {revolutions: 4, transient: 2, chaos: false}
cases:
  - grid:
      joints: [[], [big_end]]
      clearance: [0.1 mm, 0.2 mm]
      speed: [700 rpm, 740 rpm]
vary:
  crosshead.mass: {lognormal: {factor: 1.1}}
splits: {train: 70 %, validation: 15 %, test: 15 %}
";

const BUNDLE: &str = "\
format: clearance recordings 1
machine:
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
runs:
  - id: run01
    file: run01.csv
    speed_rpm: 740
    load: {suction_pressure_pa: 100000, discharge_pressure_pa: 400000}
    channels:
      - {name: time, column: t_s, unit: s}
      - {name: cylinder pressure, column: cylinder_pressure_pa, unit: Pa}
";

const CALIBRATION: &str = "\
bundle: recordings
parameters:
  rod.mass: {bounds: [10 kg, 14 kg]}
  crosshead.mass: {bounds: [10 kg, 20 kg]}
optimiser: default
seed: 1
";

fn check(files: &[&Path]) -> Output {
    crosshead(&["check"]).args(files).output().unwrap()
}

/// Line and key of each message about `file`.
fn errors_about(output: &Output, file: &Path) -> Vec<(u64, String)> {
    let prefix = format!("error: {}:", file.display());
    let lines = text(&output.stderr).lines();
    let lines = lines.filter_map(|line| line.strip_prefix(&prefix));
    lines
        .map(|line| {
            let mut parts = line.splitn(3, ':');
            let number = parts.next().unwrap().parse().unwrap();
            let rest = parts.nth(1).unwrap().trim();
            (number, rest.split(": ").next().unwrap().to_owned())
        })
        .collect()
}

#[test]
fn files_without_mistakes_are_told_by_their_kind() {
    let folder = tempfile::tempdir().unwrap();
    let files = [
        ("a", MACHINE),
        ("b", THROWS),
        ("c", BUNDLE),
        ("d", CALIBRATION),
    ];
    let mut paths = Vec::new();
    for (name, text) in files {
        paths.push(folder.path().join(format!("{name}.yaml")));
        std::fs::write(paths.last().unwrap(), text).unwrap();
    }
    std::fs::write(folder.path().join("machine.yaml"), MACHINE).unwrap();
    paths.push(folder.path().join("e.yaml"));
    std::fs::write(paths.last().unwrap(), SWEEP).unwrap();
    let paths: Vec<&Path> = paths.iter().map(|path| path.as_path()).collect();
    let output = check(&paths);
    assert!(output.status.success(), "{output:?}");
    let said = text(&output.stdout);
    for kind in [
        "a.yaml: a machine",
        "b.yaml: a machine",
        "c.yaml: a bundle",
        "d.yaml: settings",
        "e.yaml: a sweep",
    ] {
        assert!(said.contains(kind), "{said}");
    }
}

/// A file in another encoding is a mistake of that file, with the line; the others keep their results.
#[test]
fn a_file_that_is_not_utf_8_is_a_mistake_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let utf_16: Vec<u8> = MACHINE.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let latin_1 = MACHINE.replace("crank:", "# gr\u{f6}\u{df}e\ncrank:");
    let latin_1: Vec<u8> = latin_1.chars().map(|c| c as u8).collect();
    let files = [
        ("good.yaml", MACHINE.as_bytes().to_vec(), None),
        (
            "latin.yaml",
            latin_1,
            Some(":3:5: it is not text in UTF-8 from the byte 0xf6 on: save it as UTF-8"),
        ),
        (
            "wide.yaml",
            [vec![0xff, 0xfe], utf_16].concat(),
            Some(":1:1: it is text in UTF-16: save it as UTF-8"),
        ),
    ];
    let path = |name: &str| folder.path().join(name);
    for (name, content, _) in &files {
        std::fs::write(path(name), content).unwrap();
    }
    let paths: Vec<_> = files.iter().map(|(name, ..)| path(name)).collect();
    let output = crosshead(&["check", "--json"])
        .args(&paths)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for (i, (name, _, mistake)) in files.iter().enumerate() {
        let found = all[i]["mistakes"].as_array().unwrap();
        assert_eq!(
            found.len(),
            usize::from(mistake.is_some()),
            "{name}: {found:?}"
        );
        if let Some(mistake) = mistake {
            let said = text(&output.stderr);
            assert!(said.contains(&format!("{name}{mistake}")), "{said}");
        }
    }
    // One that is not there leaves the others their results, too.
    let lost = path("lost.yaml");
    let output = crosshead(&["check", "--json"])
        .args([&lost, &paths[0]])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(all.as_array().map(Vec::len), Some(1));
    assert!(text(&output.stderr).contains("lost.yaml: cannot be read"));
}

#[test]
fn mistakes_of_a_sweep_and_of_its_machine_are_told_together_by_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    let (machine, sweep) = (
        folder.path().join("machine.yaml"),
        folder.path().join("sweep.yaml"),
    );
    std::fs::write(
        &machine,
        MACHINE
            .replace("mass: 12 kg", "mass: 12")
            .replace("back: 1 bar", "bak: 1 bar"),
    )
    .unwrap();
    std::fs::write(
        &sweep,
        SWEEP
            .replace("[big_end]", "[big_ned]")
            .replace("seed: 1", "seed: x"),
    )
    .unwrap();
    for verb in ["check", "gen-dataset"] {
        let output = crosshead(&[verb]).arg(&sweep).output().unwrap();
        let of_sweep = [
            (3, "seed".to_owned()),
            (7, "cases.0.grid.joints.1.0".to_owned()),
        ];
        let of_machine = [(7, "rod.mass".to_owned()), (16, "cylinder.bak".to_owned())];
        assert_eq!(errors_about(&output, &sweep), of_sweep, "{verb}");
        assert_eq!(errors_about(&output, &machine), of_machine, "{verb}");
    }
    let output = crosshead(&["simulate"]).arg(&machine).output().unwrap();
    assert_eq!(errors_about(&output, &machine).len(), 2);
    assert_eq!(output.status.code(), Some(2));
}

/// Columns that a bundle names and its recordings lack are found from their headings; a recording that is not there is no
/// mistake, and neither is a speed that the crank angle gives.
#[test]
fn a_bundle_is_held_against_the_headings_of_its_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("recordings.yaml");
    let written = crosshead(&["init", "bundle", "--out"]).arg(&out).output();
    assert!(written.unwrap().status.success());
    assert!(check(&[folder.path()]).status.success());
    let recording = folder.path().join("run01.csv");
    let with_angle = "t_s,crank_angle_rad,crosshead_acceleration,p [bar]\n0,0,1,2\n0.001,0.1,1,2\n";
    std::fs::write(&recording, with_angle).unwrap();
    let text_of_file = std::fs::read_to_string(&out).unwrap();
    let line = |text: &str| {
        1 + text_of_file
            .lines()
            .position(|line| line.contains(text))
            .unwrap()
    };
    let missing = |channel: usize, column: &str| {
        let place = line(&format!("column: {column}"));
        (place as u64, format!("runs.0.channels.{channel}.column"))
    };
    let expected = [
        missing(2, "crosshead_acceleration_m_s2"),
        missing(3, "cylinder_pressure_pa"),
    ];
    let output = check(&[folder.path()]);
    assert_eq!(errors_about(&output, &out), expected);
    assert!(text(&output.stderr).contains("p [bar]"), "{output:?}");
    std::fs::write(&recording, "x\n").unwrap();
    let expected = [(line("file: run01.csv") as u64, "runs.0.file".to_owned())];
    assert_eq!(errors_about(&check(&[folder.path()]), &out), expected);
    let real = Path::new(env!("CARGO_MANIFEST_DIR"));
    let real = real.join("../../data/recordings/recip-compressor-pressure");
    assert!(check(&[&real]).status.success());
}

#[test]
fn a_file_that_cannot_be_read_is_no_file_with_mistakes() {
    let output = check(&[Path::new("nowhere.yaml")]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        text(&output.stderr),
        "error: nowhere.yaml: cannot be read: there is no such file\n"
    );
}
