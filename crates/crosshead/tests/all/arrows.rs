//! Dependencies between the crates run one way.

use serde_json::Value;
use std::collections::BTreeSet;
use std::process::Command;

/// What each crate may import, the lowest first. A crate that is added gets its line here.
const MAY_IMPORT: [(&str, &str); 24] = [
    ("scalar", ""),
    ("files", ""),
    ("fourier", ""),
    ("text", ""),
    ("figure", "text"),
    ("signal", "fourier scalar"),
    ("classify", ""),
    ("integrate", "scalar"),
    ("chaos", "fourier scalar"),
    ("mechanism", "scalar integrate"),
    ("simulate", "scalar integrate mechanism signal"),
    ("input", "files scalar mechanism simulate"),
    ("recordings", "files"),
    ("features", "chaos files input recordings signal simulate"),
    (
        "calibrate",
        "features files fourier input mechanism recordings scalar signal simulate",
    ),
    (
        "sweep",
        "calibrate classify features files input mechanism recordings scalar signal simulate",
    ),
    ("study", "classify recordings signal simulate sweep text"),
    (
        "gap",
        "calibrate files input mechanism recordings scalar signal simulate",
    ),
    (
        "bench",
        "calibrate files gap input mechanism recordings scalar signal simulate",
    ),
    (
        "report",
        "calibrate classify features figure gap input recordings signal simulate study sweep text",
    ),
    ("serve", "recordings report sweep"),
    (
        "cli",
        "bench calibrate chaos classify features files gap input mechanism recordings report scalar \
         serve signal simulate sweep",
    ),
    (
        "python",
        "calibrate classify cli features gap input recordings scalar signal simulate sweep",
    ),
    (
        "crosshead",
        "calibrate chaos features figure gap input integrate mechanism recordings report scalar signal \
         simulate study sweep text",
    ),
];

#[test]
fn dependencies_run_one_way() {
    let mut wrong = Vec::new();
    for (package, imports) in imports() {
        let Some((_, may)) = MAY_IMPORT.iter().find(|(name, _)| *name == package) else {
            wrong.push(format!("{package} has no line in {}", file!()));
            continue;
        };
        let may: BTreeSet<&str> = may.split_whitespace().collect();
        let not = imports.iter().filter(|name| !may.contains(name.as_str()));
        wrong.extend(not.map(|name| format!("{package} imports {name}")));
    }
    assert!(wrong.is_empty(), "against the order:\n{}", wrong.join("\n"));
}

#[test]
fn the_order_has_no_way_back() {
    for (i, (_, may)) in MAY_IMPORT.iter().enumerate() {
        for name in may.split_whitespace() {
            let lower = MAY_IMPORT[..i].iter().any(|(below, _)| *below == name);
            assert!(lower, "{name} stands above {}", MAY_IMPORT[i].0);
        }
    }
}

/// The packages of the workspace, each with those that it imports outside of its tests.
fn imports() -> Vec<(String, Vec<String>)> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version", "1"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("metadata");
    let packages = metadata["packages"].as_array().expect("packages");
    packages
        .iter()
        .map(|package| {
            let all = package["dependencies"].as_array().expect("dependencies");
            let own = all
                .iter()
                .filter(|d| d["kind"].is_null() && !d["path"].is_null());
            (
                short(&package["name"]),
                own.map(|d| short(&d["name"])).collect(),
            )
        })
        .collect()
}

/// A package's name without the prefix that all of them share.
fn short(name: &Value) -> String {
    let name = name.as_str().expect("a name");
    name.strip_prefix("crosshead-").unwrap_or(name).to_owned()
}
