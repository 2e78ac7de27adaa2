//! Small results to serve.

use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::SystemTime;
use sweep::dataset::{Claim, Failure, Output, Recording, finalize, run_part};
use sweep::{Case, Existing, Options, Plan, simulate_cases};

/// Eight cases in four shards.
const SWEEP: &str = "
name: small
seed: 5
run: {revolutions: 3, transient: 1, tolerance: 1e-7, chaos: false}
shard_size: 2
splits: {train: 100 %}
cases:
  - grid:
      joints: [[big_end], [big_end, small_end]]
      clearance: [0.1 mm, 0.3 mm]
      speed: [480 rpm, 500 rpm]
";

/// The case that fails on purpose.
pub const FAILING: &str = "case-000001";

pub fn plan(folder: &Path) -> Plan {
    let machine =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let path = folder.join("sweep-to-run.yaml");
    fs::write(&path, format!("machine: {}{SWEEP}", machine.display())).unwrap();
    let plan = Plan::read(&path).unwrap();
    fs::remove_file(path).unwrap();
    plan
}

/// A folder with the finished dataset `set`.
pub fn dataset() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let set = folder.path().join("set");
    let plan = plan(folder.path());
    begin(&plan, &set);
    make(&set, 0..plan.parts(), &|| {});
    finish(&set);
    (folder, set)
}

/// Plans the sweep in the folder `set`.
pub fn begin(plan: &Plan, set: &Path) {
    let claim = Claim::new(set, Existing::Resume).unwrap();
    claim.open(plan).unwrap();
}

/// Makes shards of the sweep in `set`. [`FAILING`] fails. `meanwhile` is called while cases are simulated.
pub fn make(set: &Path, shards: Range<u64>, meanwhile: &(dyn Fn() + Sync)) {
    let (output, plan) = Output::join(set).unwrap();
    let options = Options {
        existing: Existing::Resume,
        threads: 1,
        cancel: &AtomicBool::new(false),
        retry_failed: false,
        trial: None,
    };
    let runner = |cases: &[Case]| -> Vec<Result<Recording, Failure>> {
        meanwhile();
        let simulated = simulate_cases(cases).into_iter().zip(cases);
        let outcomes = simulated.map(|(recording, case)| match case.id.as_str() {
            FAILING => Err(Failure::from("it fails at 0.5 s on <purpose>")),
            _ => recording,
        });
        outcomes.collect()
    };
    for shard in shards {
        run_part(&plan, &output, shard, &options, &runner, &mut ()).unwrap();
    }
}

/// Makes the sweep in `set` a dataset.
pub fn finish(set: &Path) {
    let (output, plan) = Output::join(set).unwrap();
    finalize(&output, &plan).unwrap();
}

/// Every file and folder with its length and the time at which it was written.
pub fn files(folder: &Path) -> BTreeMap<PathBuf, (u64, SystemTime)> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let found = path.metadata().unwrap();
        if found.is_dir() {
            files.append(&mut self::files(&path));
        }
        files.insert(path, (found.len(), found.modified().unwrap()));
    }
    files
}
