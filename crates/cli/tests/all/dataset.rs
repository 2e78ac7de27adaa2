//! gen-dataset as a user runs it: the same bytes however it is run, and Python reads them.

use crate::dataset_bytes;
use crate::venv;

use dataset_bytes::bytes;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The root of the project.
fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A sweep of twelve cases in three shards that takes a second or two.
const SWEEP: &str = "
name: small
machine: MACHINE
seed: 7
run: {revolutions: 4, transient: 2, tolerance: 1e-8, chaos: false}
repeats: 2
windows: {count: 2, revolutions: 2}
shard_size: 5
splits: {train: 60 %, validation: 20 %, test: 20 %}
cases:
  - random:
      design: latin_hypercube
      count: 6
      axes:
        joints: [[], [big_end], [big_end, small_end]]
        clearance: {log_uniform: [0.1 mm, 0.3 mm]}
        speed: {uniform: [450 rpm, 550 rpm]}
vary:
  joints.big_end.contact.damping: {lognormal: {factor: 1.5}}
";

/// Two diagrams beside it: of other joints, so that some columns are empty.
const DIAGRAMS: &str = "
bifurcations:
  - {name: clearance, path: joints.big_end.clearance, from: 0.1 mm, to: 0.2 mm, steps: 3,
     transient: 1, revolutions: 2, chunk: 2}
  - {name: speed, path: speed, from: 450 rpm, to: 500 rpm, steps: 2, transient: 1, revolutions: 3,
     joints: [small_end], set: {clearance: 0.1 mm}, at: 30 deg}
";

fn write_sweep(folder: &Path) -> PathBuf {
    let machine = project().join("data/machines/single-stage.yaml");
    let path = folder.join("sweep.yaml");
    let text = SWEEP.replace("MACHINE", &machine.display().to_string());
    std::fs::write(&path, text).unwrap();
    path
}

fn gen_dataset(arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_gen-dataset"))
        .args(arguments)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

#[test]
fn the_bytes_do_not_depend_on_threads_and_the_resolved_sweep_gives_them_again() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = write_sweep(folder.path());
    let text = std::fs::read_to_string(&sweep).unwrap();
    std::fs::write(&sweep, text + DIAGRAMS).unwrap();
    for format in ["parquet", "mcap"] {
        let out = |name: &str| folder.path().join(format!("{name}-{format}"));
        let run = |sweep: &Path, out: &Path, threads: &str| {
            let (sweep, out) = (sweep.to_str().unwrap(), out.to_str().unwrap());
            gen_dataset(&[
                sweep,
                "--out",
                out,
                "--threads",
                threads,
                "--format",
                format,
            ]);
        };
        run(&sweep, &out("one"), "1");
        run(&sweep, &out("two"), "2");
        run(&out("one").join("sweep.yaml"), &out("again"), "2");
        let one = bytes(&out("one"));
        assert!(one.len() > 8, "{:?}", one.keys());
        for other in ["two", "again"] {
            let other = bytes(&out(other));
            assert!(one.keys().eq(other.keys()), "{format}: other files");
            for (name, content) in &one {
                assert!(*content == other[name], "{format}: {name} differs");
            }
        }
    }
    let script = venv::readers().join("read_dataset.py");
    let made = ["one-parquet", "one-mcap"].map(|name| folder.path().join(name));
    venv::run(Command::new(venv::python()).arg(script).args(made));
}

#[test]
fn the_bytes_do_not_depend_on_how_many_lanes_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = write_sweep(folder.path());
    let run = |lanes: &str| {
        let out = folder.path().join(lanes);
        let status = Command::new(env!("CARGO_BIN_EXE_gen-dataset"))
            .args([&sweep, Path::new("--out"), &out])
            .env("CROSSHEAD_LANES", lanes)
            .status();
        assert!(status.unwrap().success());
        bytes(&out)
    };
    let widest = run("8");
    for narrower in ["4", "1"] {
        assert!(run(narrower) == widest, "{narrower} lanes");
    }
}

#[test]
fn a_dry_run_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = write_sweep(folder.path());
    let text = std::fs::read_to_string(&sweep).unwrap();
    std::fs::write(&sweep, text + DIAGRAMS).unwrap();
    let out = folder.path().join("out");
    let arguments = [
        sweep.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--dry-run",
    ];
    let output = gen_dataset(&arguments);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("12 cases, 24 rows, 3 shards"), "{text}");
    assert!(
        text.contains("bifurcation diagrams: 2, 10 values"),
        "{text}"
    );
    assert!(!out.exists());
}

/// Cases of the table's lines by label: train, validation, test, all.
fn lines_by_label(stdout: &[u8]) -> Vec<(String, Vec<u64>)> {
    let text = String::from_utf8_lossy(stdout);
    let (_, table) = text.split_once("cases by label and split:\n").unwrap();
    let lines = table.lines().skip(1);
    let cells = lines.map(|line| line.split_whitespace().map(str::to_owned).collect());
    let lines: Vec<(String, Vec<u64>)> = cells
        .map_while(|cells: Vec<String>| {
            let (label, counts) = cells.split_first()?;
            let counts: Result<Vec<u64>, _> = counts.iter().map(|n| n.parse()).collect();
            Some((label.clone(), counts.ok()?))
        })
        .collect();
    lines
}

#[test]
fn the_end_is_a_table_of_cases_by_label_and_split() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = write_sweep(folder.path());
    let text = std::fs::read_to_string(&sweep).unwrap();
    let (head, _) = text.split_once("cases:").unwrap();
    // Five healthy points, and one worn one, which two of three splits lack.
    let cases = "cases:
  - grid: {speed: {from: 450 rpm, to: 550 rpm, count: 5}}
  - grid: {joints: [[big_end]], clearance: 0.2 mm}
";
    std::fs::write(&sweep, format!("{head}{cases}")).unwrap();
    let out = folder.path().join("out");
    let arguments = [sweep.to_str().unwrap(), "--out", out.to_str().unwrap()];
    let planned = gen_dataset(&[&arguments[..], &["--dry-run"]].concat());
    let made = gen_dataset(&arguments);
    let table = lines_by_label(&made.stdout);
    assert_eq!(table, lines_by_label(&planned.stdout));
    let [none, worn, all] = &table[..] else {
        panic!("{table:?}");
    };
    assert_eq!((none.0.as_str(), none.1[3]), ("none", 10));
    assert!(none.1.iter().all(|count| *count >= 2), "{none:?}");
    assert_eq!((worn.0.as_str(), worn.1[3]), ("big_end", 2));
    assert_eq!((all.0.as_str(), all.1[3]), ("all", 12));
    for output in [&planned, &made] {
        let warnings = String::from_utf8_lossy(&output.stderr).into_owned();
        let lacking = "has no case of 1 of 2 labels (big_end)";
        assert_eq!(warnings.matches(lacking).count(), 2, "{warnings}");
    }
}

#[test]
fn a_name_that_leads_out_of_the_folder_is_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = write_sweep(folder.path());
    let text = std::fs::read_to_string(&sweep).unwrap();
    std::fs::write(&sweep, text.replace("name: small", "name: ../../evil")).unwrap();
    let inner = folder.path().join("a/b");
    std::fs::create_dir_all(&inner).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_gen-dataset"))
        .arg(&sweep)
        .current_dir(&inner)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("name: found '../../evil'"), "{message}");
    assert!(!folder.path().join("a/evil").exists());
    assert!(!inner.join("datasets").exists());
}

#[test]
fn a_failing_case_is_recorded_and_the_others_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = write_sweep(folder.path());
    // A stiffness that no step is short enough for, in one of two cases.
    let text = std::fs::read_to_string(&sweep).unwrap();
    let (head, _) = text.split_once("cases:").unwrap();
    let cases = "cases:
  - zip:
      joints: [[big_end], [big_end]]
      clearance: [0.1 mm, 0.1 mm]
      joints.big_end.contact.stiffness: [24 GN/m^1.5, 1e40 GN/m^1.5]
";
    std::fs::write(
        &sweep,
        format!("{head}{cases}").replace("repeats: 2", "repeats: 1"),
    )
    .unwrap();
    let out = folder.path().join("out");
    let output = Command::new(env!("CARGO_BIN_EXE_gen-dataset"))
        .args([&sweep, Path::new("--out"), &out])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("1 of 2 cases failed"), "{message}");
    let manifest = std::fs::read_to_string(out.join("manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(manifest["failed"].as_array().unwrap().len(), 1);
    let reason = manifest["failed"][0]["reason"].as_str().unwrap();
    assert!(reason.contains("t = "), "{reason}");
    assert_eq!(manifest["counts"]["cases"], 2);
}

#[test]
fn an_interrupted_dataset_is_resumed_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = write_sweep(folder.path());
    let text = std::fs::read_to_string(&sweep).unwrap();
    std::fs::write(&sweep, text.replace("count: 6", "count: 60")).unwrap();
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    let (sweep, out) = (sweep.to_str().unwrap(), broken.to_str().unwrap());
    gen_dataset(&[sweep, "--out", whole.to_str().unwrap()]);

    let mut child = Command::new(env!("CARGO_BIN_EXE_gen-dataset"))
        .args([sweep, "--out", out, "--threads", "1"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let commits = broken.join("_sweep/commits");
    let committed = || std::fs::read_dir(&commits).map_or(0, Iterator::count);
    while committed() == 0 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let interrupt = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(interrupt.success());
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(
        message.contains("--resume continues from there"),
        "{message}"
    );
    assert!(!broken.join("manifest.json").exists());

    gen_dataset(&[sweep, "--out", out, "--resume"]);
    assert!(
        bytes(&whole) == bytes(&broken),
        "other bytes after the resumption"
    );
}

#[test]
fn a_full_disk_leaves_no_half_written_file() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = write_sweep(folder.path());
    let out = folder.path().join("out");
    // A limit on the size of files, in kilobytes: what the system refuses is a write, as on a full
    // disk. The signal that comes with it is ignored.
    let script = "trap '' XFSZ; ulimit -f 100; exec \"$@\"";
    let output = Command::new("bash")
        .args(["-c", script, "bash", env!("CARGO_BIN_EXE_gen-dataset")])
        .args([&sweep, Path::new("--out"), &out])
        .output()
        .unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
    let left = bytes(&out);
    assert!(!left.contains_key("manifest.json"));
    for (name, content) in &left {
        assert!(name == "sweep.yaml" || name.ends_with(".parquet"), "{name}");
        let whole = name == "sweep.yaml" || content.ends_with(b"PAR1");
        assert!(whole, "{name} is half written");
    }
    // With room again, it goes on from there.
    let again = folder.path().join("again");
    let (sweep, again) = (sweep.to_str().unwrap(), again.to_str().unwrap());
    gen_dataset(&[sweep, "--out", out.to_str().unwrap(), "--resume"]);
    gen_dataset(&[sweep, "--out", again]);
    assert!(bytes(&out) == bytes(Path::new(again)));
}
