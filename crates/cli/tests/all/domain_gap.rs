//! `crosshead domain-gap`: datasets of one machine beside each other, and beside one whose sensor is noisier.

use crate::small_sweep::{begin, crosshead, gen_dataset, text};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Cases that take no time. Each is a group by itself.
const SWEEP: &str = "
name: cases-SEED
machine: MACHINE
seed: SEED
run: {revolutions: 2, transient: 1, sample_rate: 2 kHz, tolerance: 1e-6, chaos: false}
splits: {train: 100 %}
cases:
  - random: {count: 80, axes: {joints: [[small_end], [big_end]], clearance: {uniform: [0.1 mm, 0.2 mm]}}}
";

/// A dataset in `folder`, of cases drawn with this seed; the noise of the accelerometer is a share of its signal.
fn dataset(folder: &Path, name: &str, seed: u32, noise: &str) -> PathBuf {
    let shipped =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let shipped = fs::read_to_string(shipped).unwrap();
    let noisy = shipped.replacen("noise: {rms: 1 %", &format!("noise: {{rms: {noise}"), 1);
    assert!(noise == "1 %" || noisy != shipped);
    let machine = folder.join(format!("{name}.machine.yaml"));
    fs::write(&machine, noisy).unwrap();
    written(
        folder,
        name,
        &SWEEP.replace("MACHINE", machine.to_str().unwrap()),
        seed,
    )
}

fn written(folder: &Path, name: &str, sweep: &str, seed: u32) -> PathBuf {
    let (_kept, path) = begin(&sweep.replace("SEED", &seed.to_string()));
    let out = folder.join(name);
    gen_dataset(&path, &out);
    out
}

fn gap(dataset: &Path, recordings: &Path, out: &Path) -> (Value, String) {
    let output = crosshead(&["domain-gap"])
        .arg(dataset)
        .arg(recordings)
        .arg("--out")
        .arg(out)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let json = fs::read_to_string(out.join("domain-gap.json")).unwrap();
    let page = fs::read_to_string(out.join("domain-gap.html")).unwrap();
    (serde_json::from_str(&json).unwrap(), page)
}

#[test]
fn what_is_alike_cannot_be_told_apart_and_noise_can() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let simulated = dataset(folder, "simulated", 1, "1 %");
    let alike = dataset(folder, "alike", 2, "1 %");
    let noisier = dataset(folder, "noisier", 3, "40 %");

    let (found, page) = gap(&simulated, &alike, &folder.join("a"));
    let auc = found["auc"].as_f64().unwrap();
    assert!((0.3..0.7).contains(&auc), "{auc}");
    assert_eq!(
        (&found["simulated"], &found["measured"]),
        (&80.into(), &80.into())
    );
    assert!(
        page.contains("80 windows of <code>cases-1</code> from the 80 measured ones"),
        "{page}"
    );

    let (found, page) = gap(&simulated, &noisier, &folder.join("b"));
    assert!(found["auc"].as_f64().unwrap() > 0.95, "{}", found["auc"]);
    // The noise is in the acceleration, and the page draws where.
    let alone = found["features"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|f| f["auc"].as_f64() > Some(0.95));
    let names: Vec<&str> = alone.map(|f| f["feature"].as_str().unwrap()).collect();
    assert!(
        !names.is_empty()
            && names
                .iter()
                .all(|name| name.starts_with("crosshead_acceleration.")),
        "{names:?}"
    );
    assert!(page.contains(found["features"][0]["feature"].as_str().unwrap()));
}

#[test]
fn recordings_that_do_not_go_with_the_dataset_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let simulated = dataset(folder, "simulated", 1, "1 %");
    let faster = SWEEP
        .replace("2 kHz", "4 kHz")
        .replace("count: 80", "count: 5");
    written(folder, "faster", &faster, 4);
    written(folder, "few", &SWEEP.replace("count: 80", "count: 4"), 5);

    for (recordings, more, message) in [
        (
            "faster",
            &[][..],
            "sample rate: found 4000 Hz, expected 2000 Hz as in the dataset",
        ),
        (
            "few",
            &[],
            "recordings: found 4 measured and 80 simulated ones, expected at least 5 of either",
        ),
        (
            "few",
            &["--window", "1 s"],
            "--window: found one beside a dataset",
        ),
        ("missing", &[], "missing"),
    ] {
        let out = folder.join("out");
        let output = crosshead(&["domain-gap"])
            .arg(&simulated)
            .arg(folder.join(recordings))
            .args(more)
            .arg("--out")
            .arg(&out)
            .output()
            .unwrap();
        let found = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{recordings}: {found}");
        assert!(found.contains(message), "{found}");
        assert!(!out.exists());
    }
}
