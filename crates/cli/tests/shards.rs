//! A dataset in steps, as several machines make it: the same bytes as gen-dataset, whatever ends.

mod dataset_bytes;
#[path = "../../../tests/readers/venv.rs"]
mod venv;

use dataset_bytes::bytes;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// Twelve cases in three shards, and two diagrams.
const SWEEP: &str = "
name: small
machine: MACHINE
seed: 7
run: {revolutions: 4, transient: 2, tolerance: 1e-8, chaos: false}
shard_size: 4
splits: {train: 60 %, test: 40 %}
cases:
  - random:
      count: 12
      axes:
        joints: [[], [big_end], [big_end, small_end]]
        clearance: {log_uniform: [0.1 mm, 0.3 mm]}
bifurcations:
  - {name: clearance, path: joints.big_end.clearance, from: 0.1 mm, to: 0.2 mm, steps: 3,
     transient: 1, revolutions: 2, chunk: 2}
  - {name: speed, path: speed, from: 450 rpm, to: 500 rpm, steps: 2, transient: 1, revolutions: 3,
     joints: [small_end], set: {clearance: 0.1 mm}, at: 30 deg}
";

/// A folder with the sweep in it.
fn begin(sweep: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let machine =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let text = sweep.replace("MACHINE", &machine.display().to_string());
    let path = folder.path().join("sweep.yaml");
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

fn crosshead(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_crosshead"));
    command.args(arguments);
    command
}

fn run(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {output:?}");
    output
}

fn gen_dataset(sweep: &Path, out: &Path) {
    run(crosshead(&["gen-dataset"]).arg(sweep).arg("--out").arg(out));
}

fn text(output: &[u8]) -> &str {
    std::str::from_utf8(output).unwrap()
}

fn assert_same(one: &Path, other: &Path) {
    let (one, other) = (bytes(one), bytes(other));
    assert!(
        one.keys().eq(other.keys()),
        "{:?} and {:?}",
        one.keys(),
        other.keys()
    );
    for (name, content) in &one {
        assert!(*content == other[name], "{name} differs");
    }
}

#[test]
fn shards_made_twice_at_once_give_the_bytes_of_gen_dataset() {
    let (folder, sweep) = begin(SWEEP);
    let (whole, parts) = (folder.path().join("whole"), folder.path().join("parts"));
    gen_dataset(&sweep, &whole);
    let out = parts.to_str().unwrap();
    let plan = || {
        run(crosshead(&["sweep", "plan"])
            .arg(&sweep)
            .args(["--out", out]))
    };
    plan();
    let planned = plan();
    assert!(
        text(&planned.stdout).contains("shards 0 to 4 (3 of cases, 2 bif"),
        "{planned:?}"
    );

    let finalize = crosshead(&["sweep", "finalize", out]).output().unwrap();
    assert_eq!(finalize.status.code(), Some(3));
    assert_eq!(text(&finalize.stdout), "0-4\n");
    // From here on the sweep file is not needed: the plan has it.
    let mut at_once: Vec<_> = (0..10)
        .map(|task: u32| {
            let mut shard = crosshead(&["sweep", "shard", out, "--threads", "1"]);
            shard.env("SLURM_ARRAY_TASK_ID", (task % 5).to_string());
            shard.stdout(Stdio::null()).spawn().unwrap()
        })
        .collect();
    for shard in &mut at_once {
        assert!(shard.wait().unwrap().success());
    }
    let again = run(&mut crosshead(&["sweep", "shard", out, "--index", "3"]));
    assert_eq!(text(&again.stdout), "shard 3: was made before\n");
    let none = crosshead(&["sweep", "shard", out, "--index", "5"])
        .output()
        .unwrap();
    assert_eq!(none.status.code(), Some(2));
    run(&mut crosshead(&["sweep", "finalize", out, "--verify"]));
    assert_same(&whole, &parts);

    // Whoever reads it does not meet what a crash left.
    let left = parts.join("_sweep/tmp/features-train-00000-of-00003.parquet.host-1-2-3.part");
    std::fs::write(left, "half").unwrap();
    read_dataset(&parts);

    let status = run(&mut crosshead(&["sweep", "status", out, "--json"]));
    let status: serde_json::Value = serde_json::from_slice(&status.stdout).unwrap();
    let found = ["complete", "shards", "made", "cases_made", "missing"].map(|key| &status[key]);
    assert_eq!(
        serde_json::json!(found),
        serde_json::json!([true, 5, 5, 12, ""])
    );

    let changed = std::fs::read_to_string(&sweep)
        .unwrap()
        .replace("seed: 7", "seed: 8");
    std::fs::write(&sweep, changed).unwrap();
    let refused = crosshead(&["sweep", "plan"])
        .arg(&sweep)
        .args(["--out", out])
        .output()
        .unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        text(&refused.stderr).contains("another sweep"),
        "{refused:?}"
    );

    // A byte that changed on the disk is seen, and its shard made again.
    let damaged = parts.join("features/train-00001-of-00003.parquet");
    let mut content = std::fs::read(&damaged).unwrap();
    content[100] ^= 1;
    std::fs::write(&damaged, content).unwrap();
    let verify = crosshead(&["sweep", "finalize", out, "--verify"])
        .output()
        .unwrap();
    assert_eq!(verify.status.code(), Some(1));
    std::fs::remove_file(damaged).unwrap();
    run(&mut crosshead(&["sweep", "shard", out, "--index", "1"]));
    run(&mut crosshead(&["sweep", "finalize", out, "--verify"]));
    assert_same(&whole, &parts);
}

#[test]
fn the_number_of_shards_can_be_chosen() {
    let (folder, sweep) = begin(SWEEP);
    let out = folder.path().join("out");
    let plan = run(crosshead(&["sweep", "plan"])
        .arg(&sweep)
        .arg("--out")
        .arg(&out)
        .args(["--shards", "6"]));
    assert!(
        text(&plan.stdout).contains("shards 0 to 7 (6 of cases"),
        "{plan:?}"
    );
    let nothing = crosshead(&["sweep", "shard"])
        .arg(folder.path())
        .args(["--index", "0"])
        .output()
        .unwrap();
    assert_eq!(nothing.status.code(), Some(2));
    assert!(
        text(&nothing.stderr).contains("no planned sweep"),
        "{nothing:?}"
    );
}

/// Many cases that take no time, in many shards.
const TINY: &str = "
name: tiny
machine: MACHINE
run: {revolutions: 1, transient: 1, sample_rate: 1 kHz, tolerance: 1e-6, chaos: false}
shard_size: 8
splits: {train: 100 %}
cases:
  - random: {count: 240, axes: {joints: [[], [big_end]], clearance: {uniform: [0.1 mm, 0.2 mm]}}}
";

/// Commits, by name and the time they were made at.
fn commits(root: &Path) -> BTreeMap<String, std::time::SystemTime> {
    let entries = std::fs::read_dir(root.join("_sweep/commits"))
        .into_iter()
        .flatten();
    entries
        .map(|entry| entry.unwrap())
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            (name, entry.metadata().unwrap().modified().unwrap())
        })
        .collect()
}

/// `CROSSHEAD_KILLS=200` for a long trial.
#[test]
fn a_sweep_that_is_killed_again_and_again_gives_the_same_bytes() {
    let kills = std::env::var("CROSSHEAD_KILLS");
    let kills: u64 = kills.map_or(5, |kills| kills.parse().unwrap());
    let (folder, sweep) = begin(TINY);
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    gen_dataset(&sweep, &whole);
    let (mut done, mut rounds) = (0, 0_u32);
    let mut random = 1_u64;
    while done < kills {
        if commits(&broken).len() == 30 {
            run(crosshead(&["gen-dataset", "--resume"])
                .arg(&sweep)
                .arg("--out")
                .arg(&broken));
            assert_same(&whole, &broken);
            std::fs::remove_dir_all(&broken).unwrap();
            rounds += 1;
        }
        let before = commits(&broken);
        let mut child = crosshead(&["gen-dataset", "--resume", "--threads", "2"])
            .arg(&sweep)
            .arg("--out")
            .arg(&broken)
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        std::thread::sleep(Duration::from_millis(20 + (random >> 33) % 400));
        // SIGKILL.
        child.kill().unwrap();
        done += u64::from(!child.wait().unwrap().success());
        if !broken.exists() {
            // It did not even come to begin.
            continue;
        }
        // What was finished before was not made again.
        let after = commits(&broken);
        assert!(before.iter().all(|(name, time)| after[name] == *time));
        // Whatever stands under a final name is whole.
        for (name, content) in bytes(&broken) {
            assert!(
                !name.ends_with(".parquet") || content.ends_with(b"PAR1"),
                "{name}"
            );
        }
    }
    run(crosshead(&["gen-dataset", "--resume"])
        .arg(&sweep)
        .arg("--out")
        .arg(&broken));
    assert_same(&whole, &broken);
    eprintln!("{done} kills over {} datasets", rounds + 1);
}

/// The fourth case asks for more memory than its process may have, and aborts: a revolution of 60 000 s is 6e7
/// samples a channel.
const POISON: &str = "
name: poison
machine: MACHINE
run: {revolutions: 1, transient: 1, sample_rate: 1 kHz, tolerance: 1e-6, chaos: false}
shard_size: 8
splits: {train: 100 %}
cases:
  - zip: {speed: [500 rpm, 501 rpm, 502 rpm, 1e-3 rpm, 503 rpm, 504 rpm, 505 rpm, 506 rpm]}
";

#[test]
fn a_case_that_its_processes_die_of_is_found() {
    use std::os::unix::process::ExitStatusExt;
    let (folder, sweep) = begin(POISON);
    let out = folder.path().join("out");
    run(crosshead(&["sweep", "plan"])
        .arg(&sweep)
        .arg("--out")
        .arg(&out));
    // Memory has an end here whatever the system promises.
    let shard = || {
        let limited = "ulimit -v 1500000; exec \"$0\" sweep shard \"$1\" --index 0 --threads 1";
        let mut command = Command::new("sh");
        command.args(["-c", limited, env!("CARGO_BIN_EXE_crosshead")]);
        command.arg(&out).output().unwrap()
    };
    // Three processes die of the shard, and three more of the case when each runs by itself.
    for attempt in 0..6 {
        let output = shard();
        assert!(output.status.signal().is_some(), "{attempt}: {output:?}");
        assert!(!out.join("_sweep/commits/0.json").exists());
    }
    let status = run(crosshead(&["sweep", "status"]).arg(&out));
    assert!(
        text(&status.stdout).contains("shard 0: 6 processes"),
        "{status:?}"
    );
    let made = shard();
    assert!(made.status.success(), "{made:?}");

    let finalized = run(crosshead(&["sweep", "finalize"]).arg(&out));
    let said = text(&finalized.stdout);
    let again = format!(
        "again: crosshead simulate {} --case case-000003",
        out.join("sweep.yaml").display()
    );
    for part in [
        "1 of 8 cases failed",
        "case-000003: the process ended without a word, three times",
        &again,
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let manifest = std::fs::read_to_string(out.join("manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(manifest["counts"]["failed"], 1);
    assert_eq!(manifest["counts"]["rows"]["train"]["none"], 7);
    // Each process has a log; the last one has the case with its command.
    let logs = logs(&out);
    assert_eq!(logs.len(), 7, "{logs:?}");
    let found: Vec<&String> = logs.iter().filter(|log| log.contains(&again)).collect();
    assert_eq!(found.len(), 1, "{logs:?}");
    assert!(found[0].contains("shard 0 begun case by case"), "{found:?}");
    assert!(found[0].contains("shard 0 made; 8 of 8 cases"), "{found:?}");
    // The command does what it says.
    let alone = Command::new("sh")
        .args([
            "-c",
            "ulimit -v 1500000; exec \"$0\" simulate \"$1\" --case case-000003",
        ])
        .arg(env!("CARGO_BIN_EXE_crosshead"))
        .arg(out.join("sweep.yaml"))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(alone.status.signal().is_some(), "{alone:?}");
}

/// The logs of a dataset.
fn logs(root: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(root.join("_sweep/logs")).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .map(|path| std::fs::read_to_string(path).unwrap())
        .collect()
}

/// Shards that take a while, of 8 cases with one row each.
const SLOW: &str = "
name: slow
machine: MACHINE
run: {revolutions: 30, transient: 30, sample_rate: 5 kHz, tolerance: 1e-9, chaos: false}
shard_size: 8
splits: {train: 60 %, test: 40 %}
cases:
  - random: {count: 32, axes: {joints: [[big_end, small_end]], clearance: {uniform: [0.1 mm, 0.2 mm]}}}
";

#[test]
fn readers_count_right_beside_what_a_crash_left() {
    let (folder, sweep) = begin(SLOW);
    let out = folder.path().join("out");
    let place = out.to_str().unwrap();
    run(crosshead(&["sweep", "plan"])
        .arg(&sweep)
        .args(["--out", place]));
    let shard = |index: &str| crosshead(&["sweep", "shard", place, "--index", index]);
    run(&mut shard("0"));
    // One is killed once its files are begun, before they are whole.
    let left = || {
        let entries = std::fs::read_dir(out.join("_sweep/tmp")).unwrap();
        let parts = entries.filter(|entry| {
            let name = entry.as_ref().unwrap().file_name();
            name.to_string_lossy().contains(".parquet.")
        });
        parts.count()
    };
    let mut killed = shard("2").stdout(Stdio::null()).spawn().unwrap();
    while left() < 4 {
        assert!(killed.try_wait().unwrap().is_none(), "it was too fast");
        std::thread::sleep(Duration::from_millis(1));
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(commits(&out).keys().eq(["0.json"]) && left() == 4);
    count_rows(&out, 8);

    for index in ["1", "2", "3"] {
        run(&mut shard(index));
    }
    run(&mut crosshead(&["sweep", "finalize", place]));
    assert_eq!(left(), 4, "what was left is not there any more");
    count_rows(&out, 32);
    read_dataset(&out);

    // As Delta tables, with the same bytes a second time.
    let export = || run(&mut crosshead(&["sweep", "export-delta", place]));
    let said = export();
    let expected = format!("{place}/features: 8 files, 32 rows");
    assert!(text(&said.stdout).contains(&expected), "{said:?}");
    let once = bytes(&out);
    assert_eq!(export().stdout, said.stdout);
    assert!(once == bytes(&out));
    read_dataset(&out);
    run(&mut crosshead(&["sweep", "finalize", place, "--verify"]));
    let log = out.join("features/_delta_log/00000000000000000000.json");
    std::fs::write(log, "{}\n").unwrap();
    let other = crosshead(&["sweep", "export-delta", place])
        .output()
        .unwrap();
    assert_eq!(other.status.code(), Some(2));
    assert!(
        text(&other.stderr).contains("another Delta table"),
        "{other:?}"
    );
}

#[test]
fn what_is_not_finished_is_no_delta_table() {
    let (folder, sweep) = begin(TINY);
    let out = folder.path().join("out");
    run(crosshead(&["sweep", "plan"])
        .arg(&sweep)
        .arg("--out")
        .arg(&out));
    let refused = crosshead(&["sweep", "export-delta"])
        .arg(&out)
        .output()
        .unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        text(&refused.stderr).contains("is not complete"),
        "{refused:?}"
    );
}

/// Every reader finds so many rows, and no case twice.
fn count_rows(dataset: &Path, rows: u64) {
    let script = venv::readers().join("count_rows.py");
    let mut command = Command::new(venv::python());
    venv::run(command.arg(script).arg(dataset).arg(rows.to_string()));
}

/// Every reader finds what the manifest says, and the same.
fn read_dataset(dataset: &Path) {
    let script = venv::readers().join("read_dataset.py");
    venv::run(Command::new(venv::python()).arg(script).arg(dataset));
}
