//! A sweep that calibrates its machine first, as a user runs it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::Duration;

/// The sweep, and beside it a bundle of two recordings that differ from the machine file in what is
/// fitted.
struct Case {
    folder: tempfile::TempDir,
}

const SWEEP: &str = "name: worn
machine: machine.yaml
calibrate:
  bundle: bundle
  parameters: [joints.big_end.contact.stiffness, joints.big_end.contact.damping]
  optimiser: levenberg_marquardt
  uncertainty: sampled
run: {revolutions: 2, transient: 1, sample_rate: 5 kHz, tolerance: 1e-7, chaos: false}
cases:
  - grid: {joints: [[big_end]], clearance: [0.1 mm, 0.2 mm], speed: [400 rpm, 500 rpm]}
";

impl Case {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
        let machine = std::fs::read(shipped.join("single-stage.yaml")).unwrap();
        std::fs::write(folder.path().join("machine.yaml"), machine).unwrap();
        std::fs::write(folder.path().join("sweep.yaml"), SWEEP).unwrap();
        let case = Self { folder };
        case.record("run01", "400 rpm", "1");
        case.record("run02", "500 rpm", "2");
        let run = |id: &str, rpm: u32| {
            format!(
                "- id: {id}
  file: {id}/signals.parquet
  speed_rpm: {rpm}
  sample_rate_hz: 10000
  load: {{suction_pressure_pa: 105000.0, discharge_pressure_pa: 393000.0}}
  joints: {{big_end: {{clearance_m: 0.0001}}, small_end: ideal}}
  channels:
  - {{name: crank angle, column: crank_angle_rad, unit: rad}}
  - {{name: crosshead acceleration, column: crosshead_acceleration_m_s2, unit: m/s2}}
"
            )
        };
        let runs = format!("runs:\n{}{}", run("run01", 400), run("run02", 500));
        std::fs::write(case.path("bundle/recordings.yaml"), runs).unwrap();
        case
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Simulates a recording of the machine as it really is.
    fn record(&self, run: &str, speed: &str, seed: &str) {
        let speed = format!("speed={speed}");
        let output = self.run(&[
            "simulate",
            "machine.yaml",
            "--out",
            &format!("bundle/{run}"),
            "--overwrite",
            "--revolutions",
            "8",
            "--seed",
            seed,
            "--set",
            &speed,
            "--set",
            "joints.big_end.clearance=0.1 mm",
            "--set",
            "joints.big_end.contact.stiffness=30 GN/m^1.5",
            "--set",
            "joints.big_end.contact.damping=1.5e4 N s/m",
        ]);
        assert!(output.status.success(), "{output:?}");
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_crosshead"));
        command
            .args(arguments)
            .current_dir(self.folder.path())
            .stdout(Stdio::null());
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = self.command(arguments);
        command.stdout(Stdio::piped()).output().unwrap()
    }

    /// Runs `gen-dataset` and hands back what it prints.
    fn generate(&self, arguments: &[&str]) -> String {
        let output = self.run(&[&["gen-dataset"], arguments].concat());
        assert!(output.status.success(), "{arguments:?}: {output:?}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// Every file of a dataset that readers see, its calibration included.
    fn bytes(&self, root: &str) -> BTreeMap<PathBuf, Vec<u8>> {
        let root = self.path(root);
        let mut files = BTreeMap::new();
        let mut folders = vec![root.clone()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).unwrap() {
                let path = entry.unwrap().path();
                let name = path.strip_prefix(&root).unwrap().to_owned();
                if name.starts_with("_sweep") {
                    continue;
                }
                if path.is_dir() {
                    folders.push(path);
                } else {
                    files.insert(name, std::fs::read(&path).unwrap());
                }
            }
        }
        files
    }
}

#[test]
fn a_sweep_calibrates_first_and_its_bytes_follow_from_the_recordings() {
    let case = Case::new();
    let text = case.generate(&["sweep.yaml", "--dry-run"]);
    assert!(text.contains("would be calibrated first"), "{text}");
    assert!(!case.path("datasets").exists());

    // Into datasets/worn, where `crosshead simulate` looks for the calibration.
    let text = case.generate(&["sweep.yaml", "--threads", "1"]);
    assert!(text.contains("joints.big_end.contact.stiffness"), "{text}");
    let one = case.bytes("datasets/worn");
    assert!(one.len() >= 4, "{:?}", one.keys());
    let resolved = std::fs::read_to_string(case.path("datasets/worn/sweep.yaml")).unwrap();
    assert!(!resolved.contains("bundle"), "{resolved}");
    assert!(resolved.contains("vary_together"), "{resolved}");
    // One clearance state excludes no relation to the clearance.
    assert!(resolved.contains("joints.*.contact.relation"), "{resolved}");
    // The sensors are those that recorded: 1 % of the signal, 1 kPa, 10 kHz.
    let path = case.path("datasets/worn/calibration");
    let results = std::fs::read_to_string(path.join("calibration.json")).unwrap();
    let results: serde_json::Value = serde_json::from_str(&results).unwrap();
    let acceleration = &results["noise"]["crosshead_acceleration_m_s2"];
    let level = acceleration["of_signal"].as_f64().unwrap();
    assert!((level / 0.01 - 1.0).abs() < 0.1, "{acceleration}");
    // 16 bits over ±2000 m/s²: the step is identifiable.
    let step = acceleration["resolution"].as_f64().unwrap();
    assert!(
        (step / (4000.0 / 65536.0) - 1.0).abs() < 1e-3,
        "{acceleration}"
    );
    assert_eq!(acceleration["converter"], "range_assumed");
    let machine = input::machine_file::read(&path.join("machine.yaml")).unwrap();
    assert_eq!(machine.resolve().unwrap().sample_rate, Some(10_000.0));

    case.generate(&["sweep.yaml", "--threads", "2", "--out", "two"]);
    assert!(one == case.bytes("two"), "two threads give other bytes");

    // Killed while it calibrated, and gone on with.
    let mut child = case.command(&["gen-dataset", "sweep.yaml", "--out", "killed"]);
    let mut child = child.stderr(Stdio::null()).spawn().unwrap();
    let checkpoint = case.path("killed/calibration/checkpoint.bin");
    let size = || std::fs::metadata(&checkpoint).map_or(0, |found| found.len());
    while size() < 10_000 && child.try_wait().unwrap().is_none() {
        thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    case.generate(&["sweep.yaml", "--out", "killed", "--resume"]);
    assert!(one == case.bytes("killed"), "a kill gives other bytes");

    // Nothing has changed: the file of the calibration stays as it is.
    let file = case.path("two/calibration/calibration.json");
    let written = || std::fs::metadata(&file).unwrap().modified().unwrap();
    let before = written();
    for how in ["--overwrite", "--resume"] {
        let text = case.generate(&["sweep.yaml", "--out", "two", how]);
        assert!(text.contains("calibrated before"), "{text}");
        assert_eq!(written(), before);
        assert!(one == case.bytes("two"), "{how} gives other bytes");
    }
    let text = case.generate(&["sweep.yaml", "--out", "two", "--dry-run"]);
    assert!(text.contains("calibrated before"), "{text}");

    // In steps.
    let step = |arguments: &[&str]| {
        let output = case.run(&[&["sweep"], arguments].concat());
        assert!(output.status.success(), "{arguments:?}: {output:?}");
    };
    step(&["plan", "sweep.yaml", "--out", "steps"]);
    step(&["shard", "steps", "--index", "0"]);
    step(&["finalize", "steps", "--verify"]);
    assert!(one == case.bytes("steps"), "in steps it gives other bytes");

    // One case, by the sweep and by the resolved sweep.
    for (sweep, out) in [("sweep.yaml", "a"), ("datasets/worn/sweep.yaml", "b")] {
        let output = case.run(&["simulate", sweep, "--case", "case-000002", "--out", out]);
        assert!(output.status.success(), "{output:?}");
    }
    assert_eq!(case.bytes("a"), case.bytes("b"));

    // Another recording: another calibration, which the dataset does not begin with.
    case.record("run02", "500 rpm", "3");
    let text = case.generate(&["sweep.yaml", "--out", "two", "--dry-run"]);
    assert!(text.contains("would be calibrated first"), "{text}");
    let output = case.run(&["gen-dataset", "sweep.yaml", "--out", "two", "--resume"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("another calibration"), "{message}");
    assert_eq!(written(), before);
    let output = case.run(&[
        "simulate",
        "sweep.yaml",
        "--case",
        "case-000002",
        "--out",
        "c",
    ]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("its own sweep.yaml"), "{message}");

    // Without any recordings the resolved sweep gives the same dataset.
    std::fs::remove_dir_all(case.path("bundle")).unwrap();
    case.generate(&["datasets/worn/sweep.yaml", "--out", "again"]);
    assert!(
        one == case.bytes("again"),
        "the resolved sweep gives other bytes"
    );
}

#[test]
fn a_bad_section_gets_one_message_and_nothing_is_written() {
    let case = Case::new();
    for (from, to, expected) in [
        ("bundle: bundle", "bundle: bndle", "bndle"),
        (
            "contact.damping]",
            "contact.dampign]",
            "did you mean 'damping'?",
        ),
        (
            "  uncertainty: sampled",
            "  uncertainty: some",
            "sweep.yaml:7:16: calibrate.uncertainty: found 'some', expected one of ignored, sampled",
        ),
    ] {
        std::fs::write(case.path("sweep.yaml"), SWEEP.replace(from, to)).unwrap();
        let output = case.run(&["gen-dataset", "sweep.yaml"]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(message.contains(expected), "{message}");
        assert!(!case.path("datasets").exists());
    }
}
