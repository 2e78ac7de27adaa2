//! `crosshead check`: all mistakes of a file in one run, in the order of its lines.

use crate::small_sweep::{crosshead, text};
use std::path::Path;
use std::process::Output;

const MACHINE: &str = "\
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

const THROWS: &str = "\
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

/// A file with its changes, and the line and key of each mistake that it has then.
type Case = (
    &'static str,
    &'static [(&'static str, &'static str)],
    &'static [(u64, &'static str)],
);

const CASES: &[Case] = &[
    (
        MACHINE,
        &[
            ("radius: 75 mm", "radius: 75"),
            ("  mass: 12 kg", "  mass: 12 mm"),
        ],
        &[(4, "crank.radius"), (7, "rod.mass")],
    ),
    (
        MACHINE,
        &[
            ("speed: 740 rpm", "sped: 740 rpm"),
            ("suction: 1 bar", "suction: 1 bra"),
            ("exponent: 1.4", "exponent: 1,4"),
        ],
        &[
            (2, "sped"),
            (14, "cylinder.suction"),
            (17, "cylinder.exponent"),
        ],
    ),
    (
        MACHINE,
        &[
            ("  centre_of_mass: 150 mm\n", ""),
            ("  inertia: 0.3 kg m^2\n", ""),
            ("  back: 1 bar\n", ""),
        ],
        &[
            (5, "rod.centre_of_mass"),
            (5, "rod.inertia"),
            (10, "cylinder.back"),
        ],
    ),
    (
        MACHINE,
        &[
            ("length: 400 mm", "length: 40 mm"),
            ("discharge: 4 bar", "discharge: 0.4 bar"),
        ],
        &[(6, "rod.length"), (15, "cylinder.discharge")],
    ),
    (
        MACHINE,
        &[
            ("length: 400 mm", "lenght: 400 mm"),
            ("  mass: 18 kg", "  mas: 18 kg"),
            ("law: impact, stiffness: 24", "law: impct, stiffness: 24"),
            ("range: 50 g", "rang: 50 g"),
        ],
        &[
            (6, "rod.lenght"),
            (11, "crosshead.mas"),
            (23, "joints.big_end.contact.law"),
            (29, "sensors.0.rang"),
        ],
    ),
    (
        MACHINE,
        &[
            ("name: small", "name: small\nname: large"),
            ("  mass: 12 kg", "  mass: 12 kg\n  mass: 13 kg"),
            ("back: 1 bar", "back: 1 kg"),
        ],
        &[(2, "name"), (9, "rod.mass"), (18, "cylinder.back")],
    ),
    (
        MACHINE,
        &[
            ("centre_of_mass: 150 mm", "centre_of_mass: 450 mm"),
            (
                "clearance: 0.1 mm\n    journal_radius: 50 mm",
                "clearance: 51 mm\n    journal_radius: 50 mm",
            ),
            ("valve_loss", "valve_los"),
        ],
        &[
            (8, "rod.centre_of_mass"),
            (21, "joints.big_end.clearance"),
            (32, "effects.0"),
        ],
    ),
    (
        MACHINE,
        &[
            ("rod:\n  length", "rod: ideal\nunused:\n  length"),
            ("measure: crank_angle", "measure: crank_angel"),
        ],
        &[(5, "rod"), (6, "unused"), (31, "sensors.1.measure")],
    ),
    (
        MACHINE,
        &[
            ("crosshead:\n  mass: 18 kg\n", ""),
            ("radius: 75 mm", "radius: wide"),
            ("bits: 16", "bits: 99"),
            ("suction: 0.18", "suction: -1"),
        ],
        &[
            (1, "crosshead"),
            (4, "crank.radius"),
            (27, "sensors.0.bits"),
            (30, "effects.0.valve_loss.suction"),
        ],
    ),
    (
        MACHINE,
        &[
            ("discharge: 4 bar", "discharge: 40 barg"),
            ("suction: 1 bar", "suction: 10 psig"),
            ("radius: 75 mm", "radius: 75 mm\n  stroke: 150 mm"),
        ],
        &[
            (5, "crank.stroke"),
            (15, "cylinder.suction"),
            (16, "cylinder.discharge"),
        ],
    ),
    (
        MACHINE,
        &[
            ("  radius: 75 mm", "  stroke: 150 kg"),
            ("piston_radius: 50 mm", "bore: 4 lb"),
            ("mass: 12 kg", "weight: 12"),
            ("small_end:", "wrist_pn:"),
        ],
        &[
            (4, "crank.stroke"),
            (7, "rod.weight"),
            (13, "cylinder.bore"),
            (24, "joints.wrist_pn"),
        ],
    ),
    (
        MACHINE,
        &[
            ("depth: 10 um}\n  small_end", "dept: 10 um}\n  small_end"),
            ("stiffness: 20 GN/m^1.5", "stiffness: 20 GN/m"),
            (
                "- {measure: crank_angle}",
                "- {measure: crank_angle, throw: a}",
            ),
        ],
        &[
            (23, "joints.big_end.contact.dept"),
            (27, "joints.small_end.contact.stiffness"),
            (30, "sensors.1.throw"),
        ],
    ),
    (
        MACHINE,
        &[
            ("exponent: 1.4", "exponent: 0"),
            ("head_clearance: 15 mm", "head_clearance: 0 mm"),
            (
                "clearance: 0.1 mm\n    journal_radius: 35",
                "clearance: 0.1 mm radal\n    journal_radius: 35",
            ),
            ("range: 50 g, ", ""),
        ],
        &[
            (17, "cylinder.exponent"),
            (18, "cylinder.head_clearance"),
            (25, "joints.small_end.clearance"),
            (29, "sensors.0.bits"),
        ],
    ),
    (
        THROWS,
        &[
            ("mass: 12 kg, ", ""),
            ("direction: opposed", "direction: oposed"),
            ("throw: throw2", "throw: throw3"),
        ],
        &[
            (4, "rod.mass"),
            (9, "throws.1.direction"),
            (12, "sensors.1.throw"),
        ],
    ),
    (
        THROWS,
        &[
            ("suction: 1 bar, ", ""),
            ("radius: 75 mm}", "radius: 75}"),
            ("name: throw2", "name: throw 2"),
            (
                "measure: cylinder_pressure, throw: throw1",
                "measure: cylinder_presure, throw: throw1",
            ),
        ],
        &[
            (3, "crank.radius"),
            (6, "cylinder.suction"),
            (9, "throws.1.name"),
            (11, "sensors.0.measure"),
        ],
    ),
    (
        THROWS,
        &[
            ("{name: throw1}", "{name: throw1, rod: {length: 10 mm}}"),
            (
                "crank_pin_angle: 180 deg",
                "crank_pin_angle: 180, colour: red",
            ),
        ],
        &[
            (8, "throws.0.rod.length"),
            (9, "throws.1.crank_pin_angle"),
            (9, "throws.1.colour"),
        ],
    ),
    (
        SWEEP,
        &[
            ("revolutions: 4", "revolution: 4"),
            ("seed: 1", "seed: -1"),
            ("0.2 mm", "0.2 kg"),
        ],
        &[
            (3, "seed"),
            (4, "run.revolution"),
            (8, "cases.0.grid.clearance.1"),
        ],
    ),
    (
        SWEEP,
        &[
            ("[big_end]", "[big_ned]"),
            ("crosshead.mass", "crosshead.mas"),
            ("test: 15 %", "test: 25 %"),
        ],
        &[
            (7, "cases.0.grid.joints.1.0"),
            (11, "vary.crosshead.mas"),
            (12, "splits"),
        ],
    ),
    (
        SWEEP,
        &[
            ("speed: [700 rpm, 740 rpm]", "sped: [700 rpm]"),
            ("factor: 1.1", "factor: 0.5"),
        ],
        &[
            (9, "cases.0.grid.sped"),
            (11, "vary.crosshead.mass.lognormal.factor"),
        ],
    ),
    (
        SWEEP,
        &[
            ("chaos: false", "chaos: perhaps, tolerance: 2"),
            ("train: 70 %", "train: 0.7"),
            ("- grid:", "- gird:"),
        ],
        &[
            (4, "run.chaos"),
            (4, "run.tolerance"),
            (6, "cases.0"),
            (12, "splits.train"),
        ],
    ),
    (
        BUNDLE,
        &[
            ("rod_mass_kg: 12", "rod_mass_kg: 12 kg"),
            ("speed_rpm: 740", "speed_rpm: fast"),
            ("unit: Pa", "unit: kg"),
        ],
        &[
            (5, "machine.rod_mass_kg"),
            (16, "runs.0.speed_rpm"),
            (20, "runs.0.channels.1.unit"),
        ],
    ),
    (
        BUNDLE,
        &[
            ("rod_length_m: 0.4", "rod_lenght_m: 0.4"),
            ("suction_pressure_pa: 100000, ", ""),
            ("file: run01.csv", "file: 7"),
        ],
        &[
            (4, "machine.rod_lenght_m"),
            (15, "runs.0.file"),
            (17, "runs.0.load.suction_pressure_pa"),
        ],
    ),
    (
        CALIBRATION,
        &[
            ("[10 kg, 14 kg]", "[14 kg, 10 kg]"),
            ("[10 kg, 20 kg]", "[10 kg, 20 mm]"),
            ("optimiser: default", "optimiser: defalt"),
        ],
        &[
            (3, "parameters.rod.mass.bounds"),
            (4, "parameters.crosshead.mass.bounds"),
            (5, "optimiser"),
        ],
    ),
    (
        CALIBRATION,
        &[
            ("bundle: recordings\n", ""),
            ("{bounds: [10 kg, 14 kg]}", "{bound: [10 kg, 14 kg]}"),
            ("seed: 1", "seed: one"),
        ],
        &[(1, "bundle"), (2, "parameters.rod.mass.bound"), (5, "seed")],
    ),
];

fn changed(file: &str, changes: &[(&str, &str)]) -> String {
    let mut text = file.to_owned();
    for (from, to) in changes {
        assert_eq!(text.matches(from).count(), 1, "{from} in\n{text}");
        text = text.replace(from, to);
    }
    text
}

fn check(files: &[&Path]) -> Output {
    crosshead(&["check"]).args(files).output().unwrap()
}

/// Line and key of each message about `file`.
fn found(output: &Output, file: &Path) -> Vec<(u64, String)> {
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
fn all_mistakes_of_a_file_are_told_at_once_in_the_order_of_lines() {
    let folder = tempfile::tempdir().unwrap();
    let machine = folder.path().join("machine.yaml");
    let mut wrong = Vec::new();
    for (file, changes, expected) in CASES {
        assert!((2..=5).contains(&expected.len()));
        std::fs::write(&machine, MACHINE).unwrap();
        let path = folder.path().join("file.yaml");
        std::fs::write(&path, changed(file, changes)).unwrap();
        let output = check(&[&path]);
        let found = found(&output, &path);
        let expected: Vec<(u64, String)> = expected
            .iter()
            .map(|(l, k)| (*l, (*k).to_owned()))
            .collect();
        if found != expected || output.status.code() != Some(1) {
            let all = text(&output.stderr);
            wrong.push(format!(
                "{changes:?}\n  found    {found:?}\n  expected {expected:?}\n{all}"
            ));
        }
    }
    assert!(CASES.len() >= 20);
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
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
        assert_eq!(found(&output, &sweep), of_sweep, "{verb}");
        assert_eq!(found(&output, &machine), of_machine, "{verb}");
    }
    let output = crosshead(&["simulate"]).arg(&machine).output().unwrap();
    assert_eq!(found(&output, &machine).len(), 2);
    assert_eq!(output.status.code(), Some(2));
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
