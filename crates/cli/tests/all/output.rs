//! What the programs print, and what they do where it cannot be printed.

use std::fs::OpenOptions;
use std::process::{Command, Stdio};

const CROSSHEAD: &str = env!("CARGO_BIN_EXE_crosshead");

/// Linux has a device that is always full.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_behind_standard_output_is_an_error() {
    let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut schema = Command::new(CROSSHEAD);
    let output = schema.args(["schema", "machine"]).stdout(full).output();
    let output = output.unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.starts_with("error: standard output: "), "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_behind_standard_error_changes_no_exit_status() {
    let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut features = Command::new(CROSSHEAD);
    features.args(["features", "no-such-file.csv", "--out", "f.parquet"]);
    let status = features.stderr(full).stdout(Stdio::null()).status();
    assert_eq!(status.unwrap().code(), Some(2));
}

#[test]
fn the_version_names_the_program() {
    for (program, name) in [
        (CROSSHEAD, "crosshead"),
        (env!("CARGO_BIN_EXE_gen-dataset"), "gen-dataset"),
    ] {
        let output = Command::new(program).arg("--version").output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(text.trim(), format!("{name} {}", env!("CARGO_PKG_VERSION")));
    }
}
