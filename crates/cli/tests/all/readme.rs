//! The commands of the README and of the pages that go on with its tour, as a new user would type them, in a folder that
//! has what a clone has.

use crate::venv;

use std::path::{Path, PathBuf};
use std::process::Command;

fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The README, and the pages that go on with its tour.
const PAGES: [&str; 5] = [
    "README.md",
    "pipelines/README.md",
    "crates/calibrate/README.md",
    "crates/gap/README.md",
    "crates/gap/PROOF.md",
];

/// The content of the pages' blocks in `language`.
fn blocks(language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    let of_page = |page: &str| -> Vec<String> {
        let text = std::fs::read_to_string(project().join(page)).unwrap();
        let parts = text.split(&fence).skip(1);
        parts
            .map(|part| part.split("```").next().unwrap_or_default().to_owned())
            .collect()
    };
    PAGES.into_iter().flat_map(of_page).collect()
}

/// One command per entry, continued lines joined.
fn commands() -> Vec<String> {
    let text = blocks("sh").join("\n").replace("\\\n", " ");
    let lines = text.lines().map(str::trim);
    lines
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_commands_of_the_readme_work() {
    let clone = tempfile::tempdir().unwrap();
    for folder in ["pipelines", "data"] {
        let from = project().join(folder).canonicalize().unwrap();
        std::os::unix::fs::symlink(from, clone.path().join(folder)).unwrap();
    }
    let mut run = 0;
    for command in commands() {
        // The tests are running; large datasets take minutes, so only their plans are tried.
        if command.starts_with("cargo test") || command.ends_with("report datasets/chaos-map") {
            continue;
        }
        let large = ["bearing-faults", "chaos-map"]
            .iter()
            .any(|name| command.ends_with(&format!("pipelines/{name}.yaml")));
        let command = if large {
            format!("{command} --dry-run")
        } else {
            command
        };
        let line = command
            .replace(
                "cargo run --release --bin gen-dataset --",
                env!("CARGO_BIN_EXE_gen-dataset"),
            )
            .replace(
                "cargo run --release --bin crosshead --",
                env!("CARGO_BIN_EXE_crosshead"),
            );
        assert!(!line.contains("cargo"), "not a command of ours: {command}");
        let output = Command::new("sh")
            .args(["-c", &line])
            .current_dir(clone.path())
            .output()
            .unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{command}: {message}");
        run += 1;
    }
    assert!(run >= 10, "the pages have only {run} commands");

    for code in blocks("python") {
        // The small dataset of the first command has the same columns.
        let code = code.replace("bearing-faults", "paper2");
        let mut python = Command::new(venv::python());
        venv::run(python.args(["-c", &code]).current_dir(clone.path()));
    }
    for file in [
        "datasets/paper2/report.html",
        "single-stage-run/picture.svg",
    ] {
        assert!(clone.path().join(file).exists(), "{file}");
    }
}
