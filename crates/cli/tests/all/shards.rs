//! A dataset in steps, as several machines make it: the same bytes as gen-dataset, whatever ends.

use crate::small_sweep;
use crate::venv;

use small_sweep::{
    SLOW, SWEEP, TINY, assert_same, begin, bytes, commits, crosshead, gen_dataset, run, text,
};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

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

#[test]
fn readers_count_right_beside_what_a_crash_left() {
    let (folder, sweep) = begin(&SLOW.replace("transient: 30", "transient: 2"));
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
