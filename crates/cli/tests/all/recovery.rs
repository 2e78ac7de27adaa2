//! Processes that end or overlap while they make a dataset: nothing finished is lost, and no case
//! fails for what happened to its process.

use crate::small_sweep;

use small_sweep::{
    SLOW, TINY, assert_same, begin, bytes, commits, crosshead, gen_dataset, run, text,
};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// All cases of [`TINY`] in one shard, which takes longer than most processes live.
fn one_shard() -> String {
    let longer = "{revolutions: 30, transient: 30, sample_rate: 1 kHz";
    TINY.replace("{revolutions: 1, transient: 1, sample_rate: 1 kHz", longer)
        .replace("count: 240", "count: 8")
}

/// Makes the dataset of `sweep` while its process is killed `kills` times at random moments.
fn kill_at_random(sweep: &str, shards: usize, kills: u64) {
    let (folder, sweep) = begin(sweep);
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    gen_dataset(&sweep, &whole);
    let resume = || {
        let mut command = crosshead(&["gen-dataset", "--resume", "--threads", "2"]);
        command.arg(&sweep).arg("--out").arg(&broken);
        command
    };
    let (mut done, mut random) = (0, 1_u64);
    while done < kills {
        if commits(&broken).len() == shards {
            run(&mut resume());
            assert_same(&whole, &broken);
            std::fs::remove_dir_all(&broken).unwrap();
        }
        let before = commits(&broken);
        let mut child = resume().stdout(Stdio::null()).spawn().unwrap();
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
    // Exit status 0: no case failed.
    run(&mut resume());
    assert_same(&whole, &broken);
    let attempts = std::fs::read_dir(broken.join("_sweep/attempts")).unwrap();
    assert_eq!(attempts.count(), 0);
}

#[test]
fn random_kills_change_no_byte_and_fail_no_case() {
    kill_at_random(TINY, 30, 4);
    kill_at_random(&one_shard(), 1, 8);
}

/// `cargo test -p crosshead-cli --test all recovery -- --ignored` (minutes).
#[test]
#[ignore = "takes minutes"]
fn two_hundred_random_kills_of_one_shard_and_of_many() {
    kill_at_random(TINY, 30, 200);
    kill_at_random(&one_shard(), 1, 200);
}

/// Waits until `count` attempts at cases or shards are under way.
fn wait_for_attempts(root: &Path, count: usize, processes: &mut [Child]) {
    let begun = Instant::now();
    let attempts = || std::fs::read_dir(root.join("_sweep/attempts")).map_or(0, Iterator::count);
    while attempts() < count {
        let alive = processes
            .iter_mut()
            .any(|p| p.try_wait().unwrap().is_none());
        assert!(
            alive && begun.elapsed() < Duration::from_secs(600),
            "too fast"
        );
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn nine_live_processes_at_one_shard_all_come_to_its_bytes() {
    let sweep = SLOW.replace("count: 32", "count: 8");
    let (folder, sweep) = begin(&sweep);
    let (whole, out) = (folder.path().join("whole"), folder.path().join("out"));
    gen_dataset(&sweep, &whole);
    run(crosshead(&["sweep", "plan"])
        .arg(&sweep)
        .arg("--out")
        .arg(&out));
    let mut processes = Vec::new();
    // Those of the second wave find three at work, and those of the third six.
    for wave in 1..=3 {
        for _ in 0..3 {
            let mut shard = crosshead(&["sweep", "shard"]);
            let shard = shard.arg(&out).args(["--index", "0", "--threads", "2"]);
            let piped = shard.stdout(Stdio::piped()).stderr(Stdio::piped());
            processes.push(piped.spawn().unwrap());
        }
        wait_for_attempts(&out, 3 * wave, &mut processes);
    }
    for process in processes {
        let output = process.wait_with_output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let said = text(&output.stdout);
        assert!(said.starts_with("shard 0: made in"), "{said}");
    }
    run(crosshead(&["sweep", "finalize", "--verify"]).arg(&out));
    assert_same(&whole, &out);
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
    // Three processes die of the shard; the next one tries its cases in processes of their own.
    for attempt in 0..3 {
        let output = shard();
        assert!(output.status.signal().is_some(), "{attempt}: {output:?}");
        assert!(!out.join("_sweep/commits/0.json").exists());
    }
    let status = run(crosshead(&["sweep", "status"]).arg(&out));
    assert!(
        text(&status.stdout).contains("shard 0: 0 processes at work, 3 ended without a result"),
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
        "case-000003: its process ended by SIGABRT (signal 6)",
        &again,
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let manifest = std::fs::read_to_string(out.join("manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(manifest["counts"]["failed"], 1);
    assert_eq!(manifest["counts"]["rows"]["train"]["none"], 7);
    assert_eq!(manifest["failed"][0]["died"], true);
    // Each process has a log; the last one has the case with its command.
    let logs = logs(&out);
    assert_eq!(logs.len(), 4, "{logs:?}");
    let found: Vec<&String> = logs.iter().filter(|log| log.contains(&again)).collect();
    assert_eq!(found.len(), 1, "{logs:?}");
    assert!(found[0].contains("shard 0: trying 8 cases"), "{found:?}");
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
