//! The Python that the reader tests run: an environment under the target folder with the packages
//! of `requirements.txt`, made by the first test that needs it.
//!
//! Included by path into the test binaries of several crates.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// `tests/readers/` of the workspace, as seen from a crate.
pub fn readers() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/readers")
}

/// The interpreter of the environment. Panics when it cannot be made: a reader that is not there
/// has read nothing.
pub fn python() -> PathBuf {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .parent()
        .expect("a folder of the target");
    let (environment, stamp) = (
        target.join("readers-venv"),
        target.join("readers-venv.stamp"),
    );
    let bin = if cfg!(windows) { "Scripts" } else { "bin" };
    let python = environment.join(bin).join("python");

    // Tests of several binaries may come here at once; the first one installs.
    let lock = File::create(target.join("readers-venv.lock")).expect("a writable target folder");
    lock.lock().expect("a lock on the environment");
    let requirements = readers().join("requirements.txt");
    let wanted = fs::read_to_string(&requirements).expect("tests/readers/requirements.txt");
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
        return python;
    }
    let _ = fs::remove_file(&stamp);
    run(Command::new("python3")
        .args(["-m", "venv", "--clear"])
        .arg(&environment));
    let pip = [
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        // Few of the modules are used, and those are compiled where they are.
        "--no-compile",
        "--requirement",
    ];
    run(Command::new(&python).args(pip).arg(&requirements));
    fs::write(&stamp, wanted).expect("a writable target folder");
    python
}

/// Runs a command to its end. Python may keep what it compiles: half of a run of a script is to compile what it imports.
pub fn output(command: &mut Command) -> Output {
    let output = command.env_remove("PYTHONDONTWRITEBYTECODE").output();
    output.unwrap_or_else(|error| panic!("{command:?}: {error}"))
}

/// Runs a command and panics with what it said unless it succeeds.
pub fn run(command: &mut Command) {
    let output = output(command);
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
}
