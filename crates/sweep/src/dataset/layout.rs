//! Files and folders of a dataset.
//!
//! Beside what readers see (`signals/`, `features/`, `mcap/`, `bifurcations/`, `README.md`,
//! `sweep.yaml`, `SHA256SUMS`, `manifest.json`) it has `_sweep/`: `plan.json` says which sweep this is, `commits/K.json` that
//! shard K is finished, `attempts/` who is at work on which shard, `logs/` what each process did and
//! when, `tmp/` holds files that are being written, and `lock` is locked by the process at work: by one alone that makes the whole dataset,
//! or by any number that make a shard each. The operating system unlocks it when a process ends,
//! however it ends.
//!
//! A sweep that calibrates its machine first keeps what it found in `calibration/`; its resolved
//! sweep names that folder, and whoever runs it gets a copy.

use super::store::Store;
use crate::Error;

/// Which sweep it is.
pub(super) const PLAN: &str = "_sweep/plan.json";
pub(super) const SWEEP: &str = "sweep.yaml";
pub(super) const SUMS: &str = "SHA256SUMS";
pub(super) const MANIFEST: &str = "manifest.json";
/// What a dataset has in its folder, apart from `_sweep`.
pub(super) const FOLDERS: [&str; 4] = ["signals", "features", "mcap", DIAGRAMS];
pub(super) const FILES: [&str; 4] = ["README.md", SWEEP, SUMS, MANIFEST];
pub(super) const WORK: [&str; 4] = ["_sweep/commits", ATTEMPTS, LOGS, "_sweep/tmp"];
/// Markers of the processes at work on shards.
pub(super) const ATTEMPTS: &str = "_sweep/attempts";
/// The logs of all processes.
pub(super) const LOGS: &str = "_sweep/logs";
/// The folder of the bifurcation diagrams, and the name of the table that its files make up.
pub(super) const DIAGRAMS: &str = "bifurcations";
/// The log of a Delta table, beside its files.
pub(super) const DELTA_LOG: &str = "_delta_log";
/// The folder of the calibration that a dataset begins with.
pub const CALIBRATION: &str = "calibration";

/// Files among the data that `known` does not know, by path: readers take them for data too.
pub(super) fn strays(store: &Store, known: impl Fn(&str) -> bool) -> Result<Vec<String>, Error> {
    let mut strays = Vec::new();
    for folder in FOLDERS {
        let names = store.names(folder)?.into_iter();
        let paths = names
            .filter(|name| name != DELTA_LOG)
            .map(|name| format!("{folder}/{name}"));
        strays.extend(paths.filter(|path| !known(path)));
    }
    strays.sort();
    Ok(strays)
}
