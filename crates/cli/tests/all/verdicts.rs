//! Runs that are no record of the machine that was asked for, as a user meets them.

use recordings::Manifest;
use std::path::Path;
use std::process::{Command, Output};

/// A shipped machine file with texts replaced, in a folder.
fn machine(folder: &Path, name: &str, changes: &[(&str, &str)]) -> String {
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    let mut text = std::fs::read_to_string(machines.join(name)).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    std::fs::write(folder.join(name), text).unwrap();
    name.to_owned()
}

/// The motor of the two-stage machine, too weak for it.
const WEAK: [(&str, &str); 2] = [
    ("mean_torque: 6665 N m", "mean_torque: 100 N m"),
    ("slope: 2.3e4 N m s", "slope: 10 N m s"),
];

fn gen_dataset(folder: &Path, sweep: &str) -> Output {
    std::fs::write(folder.join("sweep.yaml"), sweep).unwrap();
    Command::new(env!("CARGO_BIN_EXE_gen-dataset"))
        .current_dir(folder)
        .args(["sweep.yaml", "--out", "out", "--threads", "1"])
        .output()
        .unwrap()
}

fn sweep(machine: &str, run: &str, case: &str) -> String {
    format!("name: small\nmachine: {machine}\nseed: 1\nrun: {run}\ncases:\n  - {case}\n")
}

#[test]
fn a_stalled_machine_is_a_failed_case_with_its_reason_and_command() {
    let folder = tempfile::tempdir().unwrap();
    let machine = machine(folder.path(), "two-stage.yaml", &WEAK);
    let case = "grid: {joints: [[throw1.big_end]], clearance: [0.2 mm]}";
    let run = "{revolutions: 2, transient: 60, tolerance: 1e-6, chaos: false}";
    let output = gen_dataset(folder.path(), &sweep(&machine, run, case));
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{text}");
    let manifest = Manifest::read(&folder.path().join("out/manifest.json")).unwrap();
    let [failed] = &manifest.failed[..] else {
        panic!("{manifest:?}")
    };
    assert!(failed.reason.contains("496 rpm"), "{}", failed.reason);
    assert!(failed.command.starts_with("crosshead simulate"));
}

#[test]
fn contact_deeper_than_the_clearance_is_a_warning_of_the_manifest_and_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let changes = [("piston_radius: 50 mm", "piston_radius: 200 mm")];
    let machine = machine(folder.path(), "single-stage.yaml", &changes);
    let case = "grid: {joints: [[], [big_end]], clearance: [0.05 mm]}";
    let run = "{revolutions: 1, transient: 1, tolerance: 1e-6, chaos: false}";
    let output = gen_dataset(folder.path(), &sweep(&machine, run, case));
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{output:?}");
    let manifest = Manifest::read(&folder.path().join("out/manifest.json")).unwrap();
    let [warning] = &manifest.warnings[..] else {
        panic!("{manifest:?}")
    };
    assert!(
        warning
            .warning
            .starts_with("big_end: the surfaces penetrate")
    );
    let told = format!("{}: {}", warning.case_id, warning.warning);
    assert!(
        text.contains("warnings: 1\n") && text.contains(&told),
        "{text}"
    );
}

#[test]
fn a_sample_rate_that_gives_no_record_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let machine = machine(folder.path(), "single-stage.yaml", &[]);
    for (rate, expected) in [("1e12 Hz", "at most"), ("5 Hz", "at least 20.8333 Hz")] {
        let case = "grid: {joints: [[big_end]], clearance: [0.1 mm]}";
        let run = format!("{{revolutions: 2, transient: 1, sample_rate: {rate}}}");
        let output = gen_dataset(folder.path(), &sweep(&machine, &run, case));
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(
            text.contains("run.sample_rate") && text.contains(expected),
            "{text}"
        );
        assert!(!folder.path().join("out").exists());
    }
}
