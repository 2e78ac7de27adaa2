//! A machine of one's own, from a data sheet in US units to a labelled dataset: what a new user does.

use crate::small_sweep::{crosshead, run, text};
use input::machine_file;
use mechanism::joints::revolute::Revolute;
use recordings::formats::parquet::read_table;
use std::f64::consts::PI;
use std::path::Path;

/// `file` with the line of `key` (dotted, from the top) replaced by `line`.
fn edit(file: &str, key: &str, line: &str) -> String {
    let lines: Vec<&str> = file.lines().collect();
    let mut at = 0;
    for part in key.split('.') {
        let start = format!("{part}:");
        let is_it = |line: &&str| {
            line.trim_start()
                .trim_start_matches("- ")
                .starts_with(&start)
        };
        let found = lines[at..].iter().position(is_it);
        at += found.unwrap_or_else(|| panic!("no {key} in\n{file}")) + 1;
    }
    let old = lines[at - 1];
    let indent = old.len() - old.trim_start().len();
    let new = format!("{}{line}", " ".repeat(indent));
    let mut lines: Vec<String> = lines.into_iter().map(str::to_owned).collect();
    lines[at - 1] = new;
    lines.join("\n") + "\n"
}

/// The sheet, in its words; its reader forgets two things.
fn as_on_the_sheet(template: &str) -> String {
    let mut file = template.to_owned();
    for (key, line) in [
        ("name", "name: two-throw gas compressor"),
        ("speed", "rpm: 740"),
        ("crank.radius", "stroke: 6 in"),
        ("rod.length", "length: 16 in"),
        ("rod.mass", "weight: 95 lb"),
        ("rod.centre_of_mass", "center_of_gravity: 5.5 in"),
        ("rod.inertia", "moment_of_inertia: 5400 lb in^2"),
        ("crosshead.mass", "weight: 210 lb"),
        ("cylinder.piston_radius", "bore: 9.5 in"),
        ("cylinder.suction", "suction: 50 psig"),
        ("cylinder.discharge", "discharge: 150 psig"),
        ("cylinder.back", "back: 0 psig"),
        ("cylinder.exponent", "exponent: 1.26"),
        ("cylinder.head_clearance", "clearance_volume: 16 %"),
        ("crank_end.rod_radius", "rod_diameter: 2.5 in"),
        ("crank_end.clearance", "clearance_volume: 18 %"),
        ("joints.big_end.journal_radius", "jornal_radius: 2.5 in"),
        ("joints.big_end.clearance", "diametral_clearance: 0.006 in"),
        (
            "joints.big_end.normal_clearance",
            "normal_clearance: 6 mil diametral",
        ),
        (
            "joints.small_end.clearance",
            "clearance: 0.004 in diametral",
        ),
        (
            "joints.small_end.normal_clearance",
            "normal_clearance: 0.004 in diametral",
        ),
        ("joints.small_end.journal_radius", "pin_diameter: 3.5 in"),
        ("throws.name", "- name: throw1\n    bore: 9.5 in"),
    ] {
        file = edit(&file, key, line);
    }
    file.replace(
        "name: throw2\n",
        "name: throw2\n    bore: 6 in\n    suction_pressure: 148 psig\n    discharge_pressure: 420 psig\n    clearance_volume: 20 %\n",
    )
}

fn check(file: &Path) -> (bool, String) {
    let output = crosshead(&["check"]).arg(file).output().unwrap();
    (output.status.success(), text(&output.stderr).to_owned())
}

fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 4e-16 * expected.abs()
}

const INCH: f64 = 0.0254;
const POUND: f64 = 0.45359237;
const PSI: f64 = 6894.757293168361;

/// What the simulation sees, against the sheet converted by hand.
fn is_the_machine_of_the_sheet(path: &Path) {
    let machine = machine_file::read(path).unwrap().resolve().unwrap();
    assert!(near(machine.speed, 740.0 * 2.0 * PI / 60.0));
    for (i, bore, suction, discharge, head) in
        [(0, 9.5, 50.0, 150.0, 0.16), (1, 6.0, 148.0, 420.0, 0.20)]
    {
        let throw = &machine.machine.throws[i];
        assert!(near(throw.crank_radius, 3.0 * INCH));
        assert!(near(throw.rod.length, 16.0 * INCH));
        assert!(near(throw.rod.mass, 95.0 * POUND));
        assert!(near(throw.rod.centre_of_mass, 5.5 * INCH));
        assert!(near(throw.rod.inertia, 5400.0 * POUND * INCH * INCH));
        assert!(near(throw.crosshead.mass, 210.0 * POUND));
        assert!(near(throw.cylinder.piston_radius, bore / 2.0 * INCH));
        assert!(near(throw.cylinder.suction, (suction + 14.7) * PSI));
        assert!(near(throw.cylinder.discharge, (discharge + 14.7) * PSI));
        assert!(near(throw.cylinder.head_clearance, head * 6.0 * INCH));
        let end = throw.cylinder.crank_end.as_ref().unwrap();
        assert!(near(end.clearance, 0.18 * 6.0 * INCH) && near(end.rod_radius, 1.25 * INCH));
        for (joint, radius, clearance) in [
            (&throw.big_end, 2.5, 0.003),
            (&throw.small_end, 1.75, 0.002),
        ] {
            let Revolute::Clear(joint) = joint else {
                panic!("an ideal joint")
            };
            assert!(near(joint.journal_radius, radius * INCH));
            assert!(near(joint.clearance, clearance * INCH));
        }
    }
}

#[test]
fn a_data_sheet_becomes_a_dataset_in_few_round_trips() {
    let folder = tempfile::tempdir().unwrap();
    let machine = folder.path().join("machine.yaml");
    run(crosshead(&[
        "init",
        "machine",
        "--throws",
        "2",
        "--double-acting",
        "--out",
    ])
    .arg(&machine));
    assert!(check(&machine).0);
    let template = std::fs::read_to_string(&machine).unwrap();
    let mut sheet = as_on_the_sheet(&template);

    let mut round_trips = 0;
    loop {
        std::fs::write(&machine, &sheet).unwrap();
        let (good, message) = check(&machine);
        if good {
            break;
        }
        round_trips += 1;
        assert!(round_trips <= 3, "{message}");
        // Does what the messages say, and nothing else.
        let before = sheet.clone();
        if message.contains("has the key ambient_pressure") {
            sheet = edit(&sheet, "rpm", "rpm: 740\nambient_pressure: 14.7 psia");
        }
        if message.contains("did you mean 'journal_radius'?") {
            sheet = sheet.replace("jornal_radius", "journal_radius");
        }
        assert_ne!(sheet, before, "{message}");
    }
    assert_eq!(round_trips, 1, "both mistakes are told at once");
    is_the_machine_of_the_sheet(&machine);

    let sweep = folder.path().join("sweep.yaml");
    run(crosshead(&["init", "sweep", "--out"]).arg(&sweep));
    assert!(check(&sweep).0);
    let text = std::fs::read_to_string(&sweep).unwrap();
    let mut small = text.clone();
    for (key, line) in [
        ("count", "count: 1"),
        ("windows.revolutions", "revolutions: 2"),
        ("run.revolutions", "revolutions: 2"),
        ("run.transient", "transient: 1"),
        ("random.count", "count: 4"),
        ("splits.train", "train: 100 %"),
        ("splits.validation", "validation: 0 %"),
        ("splits.test", "test: 0 %"),
    ] {
        small = edit(&small, key, line);
    }
    std::fs::write(&sweep, small).unwrap();
    let out = folder.path().join("dataset");
    run(crosshead(&["gen-dataset"])
        .arg(&sweep)
        .arg("--out")
        .arg(&out));
    labels_are_right(&out);
}

/// A joint is faulty where its clearance is above the normal one, and named so.
fn labels_are_right(dataset: &Path) {
    let entries = std::fs::read_dir(dataset.join("features")).unwrap();
    let mut rows = 0;
    for entry in entries {
        let table = read_table(&entry.unwrap().path()).unwrap();
        let faults = table.values::<String>("fault").unwrap();
        for (row, fault) in faults.iter().enumerate() {
            let mut expected = Vec::new();
            for (joint, normal) in [("big_end", 0.003 * INCH), ("small_end", 0.002 * INCH)] {
                for throw in ["throw1", "throw2"] {
                    let column = format!("clearance_{throw}.{joint}_m");
                    let clearance = table.values::<f64>(&column).unwrap()[row].unwrap();
                    match (1e-4..=3e-4).contains(&clearance) {
                        true => expected.push(format!("{throw}.{joint}")),
                        false => assert!(near(clearance, normal), "{column}: {clearance}"),
                    }
                }
            }
            let expected = if expected.is_empty() {
                "none".to_owned()
            } else {
                expected.join("+")
            };
            assert_eq!(fault.as_deref(), Some(expected.as_str()));
            let speed = table.values::<f64>("speed_rpm").unwrap()[row].unwrap();
            assert!((592.0..=814.0).contains(&speed), "{speed}");
            rows += 1;
        }
    }
    assert_eq!(rows, 4);
}

#[test]
fn a_file_is_never_replaced_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("calibration.yaml");
    std::fs::write(&path, "mine\n").unwrap();
    let output = crosshead(&["init", "calibration", "--out"])
        .arg(&path)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine\n");
    run(crosshead(&["init", "calibration", "--overwrite", "--out"]).arg(&path));
    assert!(check(&path).0);
}

#[test]
fn every_file_is_right_as_it_is_written() {
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let two = machines.join("two-stage.yaml");
    let two = two.to_str().unwrap();
    for (i, options) in [
        &[][..],
        &["--double-acting"],
        &["--throws", "3"],
        &["--throws", "4", "--double-acting"],
        &["--like", two],
        &["--like", two, "--throws", "1"],
        &["--like", two, "--throws", "6"],
    ]
    .into_iter()
    .enumerate()
    {
        let (machine, sweep) = (file(&format!("{i}.yaml")), file(&format!("sweep{i}.yaml")));
        run(crosshead(&["init", "machine", "--out"])
            .arg(&machine)
            .args(options));
        run(crosshead(&["init", "sweep", "--machine"])
            .arg(&machine)
            .arg("--out")
            .arg(&sweep));
        let output = run(crosshead(&["check"]).args([&machine, &sweep]));
        assert!(
            text(&output.stdout).contains("a machine, no mistakes"),
            "{output:?}"
        );
    }
    // With the columns of the template.
    let columns = "t_s,crank_angle_rad,crosshead_acceleration_m_s2,cylinder_pressure_pa";
    let recording = format!("{columns}\n0,0,1,1e5\n0.001,0.1,1,1e5\n");
    std::fs::write(file("a.csv"), recording).unwrap();
    for (kind, name) in [
        ("bundle", "recordings.yaml"),
        ("calibration", "calibration.yaml"),
    ] {
        run(crosshead(&["init", kind, "--out"]).arg(file(name)));
        run(crosshead(&["check"]).arg(file(name)));
    }
    let bundle = std::fs::read_to_string(file("recordings.yaml")).unwrap();
    assert!(bundle.contains("file: a.csv"), "{bundle}");
}

#[test]
fn a_bundle_is_written_from_the_headings_of_its_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let rows = |i: usize| format!("{},{},{},7\n", i as f64 / 2000.0, i % 3, 10 + i % 2);
    let rows: String = (0..50).map(rows).collect();
    let csv = format!("Time [s],Vib [g],Head end (psig),Motor [V]\n{rows}");
    std::fs::write(file("monday.csv"), csv).unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/recordings");
    std::fs::copy(shipped.join("netcdf-4.nc"), file("tuesday.nc")).unwrap();
    std::fs::copy(shipped.join("matlab-v7.3.mat"), file("wednesday.mat")).unwrap();
    std::fs::write(file("notes.txt"), "no recording").unwrap();

    let output = run(crosshead(&["init", "bundle", "--out"]).arg(file("recordings.yaml")));
    let left_out = text(&output.stderr);
    assert!(
        left_out.contains("left out") && left_out.contains("notes.txt"),
        "{left_out}"
    );
    run(crosshead(&["check"]).arg(file("recordings.yaml")));
    let written = std::fs::read_to_string(file("recordings.yaml")).unwrap();
    let values = |line: &str| line.split('#').next().unwrap_or_default().trim().to_owned();
    let lines: Vec<String> = written.lines().map(values).collect();
    for line in [
        "file: monday.csv",
        "sample_rate_hz: 2000.0",
        "- name: crosshead acceleration",
        "column: \"Vib [g]\"",
        "unit: g",
        "column: \"Head end (psig)\"",
        "offset: 14.6959",
        "- name: \"Motor [V]\"",
        "file: tuesday.nc",
        "- name: pressure",
        "unit: kPa",
        "file: wednesday.mat",
        "speed_rpm: 1796.0",
        "unit: m/s^2",
    ] {
        assert!(
            lines.iter().any(|found| found == line),
            "{line}:\n{written}"
        );
    }
    assert!(!written.contains("notes"), "{written}");
}

#[test]
fn a_bundle_gives_its_nominal_machine() {
    let folder = tempfile::tempdir().unwrap();
    let bundle = Path::new(env!("CARGO_MANIFEST_DIR"));
    let bundle = bundle.join("../../data/recordings/example-diagnosis/healthy");
    let mut command = crosshead(&["init", "machine", "--from-bundle"]);
    run(command.arg(&bundle).current_dir(folder.path()));
    let machine = machine_file::read(&folder.path().join("machine.yaml")).unwrap();
    let resolved = machine.resolve().unwrap();
    // Its first run: 400 rpm, both joints of the rod with 0.03 mm.
    assert!((resolved.speed - 400.0 * PI / 30.0).abs() < 1e-9);
    let throw = &resolved.machine.throws[0];
    for joint in [&throw.big_end, &throw.small_end] {
        let Revolute::Clear(clear) = joint else {
            panic!("{joint:?}")
        };
        assert!((clear.clearance - 3e-5).abs() < 1e-12);
    }
    let mut command = crosshead(&["init", "sweep", "--from-bundle"]);
    let wrong = command.arg(&bundle).current_dir(folder.path()).output();
    let wrong = wrong.unwrap();
    assert_eq!(wrong.status.code(), Some(2));
    assert!(text(&wrong.stderr).contains("--from-bundle are options of init machine"));
}
