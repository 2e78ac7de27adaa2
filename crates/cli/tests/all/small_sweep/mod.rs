//! Small sweeps and the programs that make them.

use crate::dataset_bytes;

pub use dataset_bytes::bytes;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Twelve cases in three shards, and two diagrams.
pub const SWEEP: &str = "
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
pub fn begin(sweep: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let machine =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let text = sweep.replace("MACHINE", &machine.display().to_string());
    let path = folder.path().join("sweep.yaml");
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

pub fn crosshead(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_crosshead"));
    command.args(arguments);
    command
}

pub fn run(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {output:?}");
    output
}

pub fn gen_dataset(sweep: &Path, out: &Path) {
    run(crosshead(&["gen-dataset"]).arg(sweep).arg("--out").arg(out));
}

pub fn text(output: &[u8]) -> &str {
    std::str::from_utf8(output).unwrap()
}

/// Many cases that take no time, in many shards.
pub const TINY: &str = "
name: tiny
machine: MACHINE
run: {revolutions: 1, transient: 1, sample_rate: 1 kHz, tolerance: 1e-6, chaos: false}
shard_size: 8
splits: {train: 100 %}
cases:
  - random: {count: 240, axes: {joints: [[], [big_end]], clearance: {uniform: [0.1 mm, 0.2 mm]}}}
";

/// Shards that take a while, of 8 cases with one row each.
pub const SLOW: &str = "
name: slow
machine: MACHINE
run: {revolutions: 30, transient: 30, sample_rate: 5 kHz, tolerance: 1e-9, chaos: false}
shard_size: 8
splits: {train: 60 %, test: 40 %}
cases:
  - random: {count: 32, axes: {joints: [[big_end, small_end]], clearance: {uniform: [0.1 mm, 0.2 mm]}}}
";

pub fn assert_same(one: &Path, other: &Path) {
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

/// Commits, by name and the time they were made at.
pub fn commits(root: &Path) -> BTreeMap<String, std::time::SystemTime> {
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
