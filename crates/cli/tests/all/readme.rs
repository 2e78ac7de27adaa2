//! The commands of the README and of the pages that continue its tour, as a new user types them, in a folder that has what
//! a clone has.

use crate::venv;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The pages that continue the README's tour.
const TOUR: [&str; 5] = [
    "pipelines/README.md",
    "crates/calibrate/README.md",
    "crates/calibrate/WEAR.md",
    "crates/gap/README.md",
    "crates/gap/PROOF.md",
];

fn page(path: &str) -> String {
    std::fs::read_to_string(project().join(path)).unwrap()
}

/// The section of a page below `heading`, up to the next one of its level.
pub fn section(path: &str, heading: &str) -> String {
    let text = page(path);
    let (_, rest) = text.split_once(&format!("\n## {heading}\n")).unwrap();
    let section = rest.split("\n## ").next().unwrap_or_default();
    section.to_owned()
}

/// The blocks of a text in `language`, joined.
fn blocks(text: &str, language: &str) -> String {
    let fence = format!("```{language}\n");
    let blocks = text.split(&fence).skip(1);
    blocks
        .map(|block| block.split("```").next().unwrap_or_default())
        .collect()
}

/// One command per entry, continued lines joined.
fn commands(text: &str) -> Vec<String> {
    let text = blocks(text, "sh").replace("\\\n", " ");
    let lines = text.lines().map(str::trim);
    lines
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(str::to_owned)
        .collect()
}

/// A folder with what a clone has besides its code.
pub fn clone() -> tempfile::TempDir {
    let clone = tempfile::tempdir().unwrap();
    for folder in ["pipelines", "data"] {
        let from = project().join(folder).canonicalize().unwrap();
        std::os::unix::fs::symlink(from, clone.path().join(folder)).unwrap();
    }
    clone
}

/// Runs the commands of a text in `clone`, each once, and counts them. Of a dataset that takes minutes only the plan is made,
/// and `cargo test` is running already.
pub fn run(text: &str, clone: &Path) -> usize {
    let mut run = BTreeSet::new();
    for command in commands(text) {
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
        if !run.insert(command.clone()) {
            continue;
        }
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
            .current_dir(clone)
            .output()
            .unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{command}: {message}");
    }
    run.len()
}

#[test]
fn the_commands_of_the_readme_work() {
    let clone = clone();
    let readme = page("README.md");
    assert!(run(&readme, clone.path()) >= 5);
    let code = blocks(&readme, "python");
    // The small dataset of the first command has the same columns.
    let code = code.replace("bearing-faults", "paper2");
    let mut python = Command::new(venv::python());
    venv::run(python.args(["-c", &code]).current_dir(clone.path()));
    for file in [
        "datasets/paper2/report.html",
        "single-stage-run/picture.svg",
    ] {
        assert!(clone.path().join(file).exists(), "{file}");
    }
}

#[test]
#[ignore = "minutes: tests/nightly/run tour"]
fn the_commands_of_the_tour_work() {
    let clone = clone();
    let commands: usize = TOUR.iter().map(|path| run(&page(path), clone.path())).sum();
    assert!(commands >= 6, "the pages have only {commands} commands");
}
