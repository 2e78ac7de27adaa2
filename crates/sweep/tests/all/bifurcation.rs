//! Bifurcation diagrams of a real machine, as a dataset has them.

use input::yaml::Document;
use recordings::formats::parquet::read_table;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use sweep::{Error, Existing, Options, Plan, Progress, generate, simulate_cases};

const SWEEP: &str = "
name: diagrams
machine: single-stage.yaml
run: {revolutions: 1, transient: 0, tolerance: 1e-7}
splits: {train: 100 %}
cases:
  - grid: {speed: 500 rpm}
bifurcations:
  - name: big-end
    path: joints.big_end.clearance
    from: 0.1 mm
    to: 0.2 mm
    steps: 5
    transient: 1
    revolutions: 2
    chunk: 2
  - name: speed
    path: speed
    from: 400 rpm
    to: 500 rpm
    steps: 3
    transient: 2
    revolutions: 3
    directions: down
    at: 90 deg
    joints: [small_end]
    set: {clearance: 0.1 mm, load: {discharge: 0.3 MPa}}
";

fn plan(text: &str) -> Plan {
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    Plan::new(&Document::parse(text, "sweep.yaml").unwrap(), &machines).unwrap()
}

/// Sets a flag when so many values are done.
struct StopAfter<'a>(u64, &'a AtomicBool);

impl Progress for StopAfter<'_> {
    fn values_done(&mut self, values: u64) {
        self.0 = self.0.saturating_sub(values);
        self.1.store(self.0 == 0, SeqCst);
    }
}

fn run(plan: &Plan, root: &Path, threads: usize, stop_after: u64) -> Result<(), Error> {
    let cancel = AtomicBool::new(false);
    let options = Options {
        existing: Existing::Resume,
        threads,
        cancel: &cancel,
        retry_failed: false,
        trial: None,
    };
    let mut progress = StopAfter(stop_after, &cancel);
    generate(plan, root, &options, &simulate_cases, &mut progress).map(|_| ())
}

/// Every file below `root`, by path.
fn files(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.extend((!path.ends_with("_sweep/logs")).then_some(path));
            } else {
                let name = path.strip_prefix(root).unwrap().display().to_string();
                found.insert(name, fs::read(path).unwrap());
            }
        }
    }
    found
}

#[test]
fn threads_and_interruptions_change_no_byte() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two, broken] = ["one", "two", "broken"].map(|name| folder.path().join(name));
    let plan = plan(SWEEP);
    run(&plan, &one, 1, u64::MAX).unwrap();
    run(&plan, &two, 2, u64::MAX).unwrap();
    // One diagram whole, the other begun.
    let stopped = run(&plan, &broken, 2, 10);
    assert!(
        matches!(
            stopped,
            Err(Error::DiagramsCancelled {
                done: 1,
                diagrams: 2
            })
        ),
        "{stopped:?}"
    );
    let kept = fs::metadata(broken.join("bifurcations/big-end.parquet")).unwrap();
    assert!(!broken.join("bifurcations/speed.parquet").exists());
    run(&plan, &broken, 1, u64::MAX).unwrap();
    let again = fs::metadata(broken.join("bifurcations/big-end.parquet")).unwrap();
    assert_eq!(kept.modified().unwrap(), again.modified().unwrap());

    let whole = files(&one);
    for other in [files(&two), files(&broken)] {
        assert!(whole.keys().eq(other.keys()));
        for (name, content) in &whole {
            assert!(*content == other[name], "{name} differs");
        }
    }
    let manifest = String::from_utf8(whole["manifest.json"].clone()).unwrap();
    assert!(manifest.contains("bifurcations/speed.parquet"));
    let card = String::from_utf8(whole["README.md"].clone()).unwrap();
    assert!(
        card.contains("- config_name: \"bifurcations\"\n  data_files: \"bifurcations/*.parquet\"")
    );

    let table = read_table(&one.join("bifurcations/big-end.parquet")).unwrap();
    let values: &[Option<f64>] = table.values("value").unwrap();
    let millimetres = values.iter().map(|v| (v.unwrap() * 1e6).round() / 1e3);
    let up = [0.1, 0.125, 0.15, 0.175, 0.2];
    assert!(millimetres.eq(up.into_iter().chain(up.into_iter().rev())));
    let directions: &[Option<String>] = table.values("direction").unwrap();
    assert_eq!(directions[4].as_deref(), Some("up"));
    assert_eq!(directions[5].as_deref(), Some("down"));
    let units: &[Option<String>] = table.values("unit").unwrap();
    assert_eq!(units[0].as_deref(), Some("m"));
    let [offsets, none] = ["big_end_x_m", "small_end_x_m"].map(|name| {
        let values: &[Option<Vec<f32>>] = table.values(name).unwrap();
        values.to_vec()
    });
    // Pressed outward at top dead centre, a little beyond the clearance.
    for (offset, c) in offsets.iter().zip(values) {
        let offset = offset.as_ref().unwrap();
        let depth = f64::from(offset[1].abs()) - c.unwrap();
        assert!(offset.len() == 2 && (0.0..1e-4).contains(&depth), "{depth}");
    }
    assert!(none.iter().all(Option::is_none));

    let table = read_table(&one.join("bifurcations/speed.parquet")).unwrap();
    let values: &[Option<f64>] = table.values("value").unwrap();
    assert_eq!(values, [Some(500.0), Some(450.0), Some(400.0)]);
    let peaks: &[Option<Vec<f32>>] = table.values("peak_acceleration_m_s2").unwrap();
    for (peak, speed) in peaks.iter().zip(values) {
        // Of the ideal machine, and more for the clearance.
        let omega = speed.unwrap() * std::f64::consts::PI / 30.0;
        let share = f64::from(peak.as_ref().unwrap()[2]) / (omega * omega * 0.12 * 1.2);
        assert!((1.0..3.0).contains(&share), "{share}");
    }
}

#[test]
fn a_value_that_fails_has_a_reason_and_the_others_their_points() {
    let folder = tempfile::tempdir().unwrap();
    let (head, _) = SWEEP.split_once("bifurcations:").unwrap();
    // No step is short enough for the second stiffness.
    let diagram = "bifurcations:
  - name: stiffness
    path: joints.big_end.contact.stiffness
    from: 24 GN/m^1.5
    to: 1e40 GN/m^1.5
    steps: 2
    transient: 1
    revolutions: 1
    set: {joints.big_end.clearance: 0.1 mm}
";
    let plan = plan(&format!("{head}{diagram}"));
    run(&plan, folder.path(), 2, u64::MAX).unwrap();
    let table = read_table(&folder.path().join("bifurcations/stiffness.parquet")).unwrap();
    let reasons: &[Option<String>] = table.values("reason").unwrap();
    let points: &[Option<Vec<f32>>] = table.values("big_end_y_m").unwrap();
    // Up: the second value fails; down: it fails, and the first starts afresh.
    let failed = [false, true, true, false];
    for ((reason, points), failed) in reasons.iter().zip(points).zip(failed) {
        assert_eq!(reason.is_some(), failed, "{reasons:?}");
        assert_eq!(points.is_none(), failed);
    }
    assert!(reasons[1].as_ref().unwrap().contains("t = "), "{reasons:?}");
}
