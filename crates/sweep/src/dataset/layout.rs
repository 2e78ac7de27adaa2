//! Files and folders of a dataset.
//!
//! Readers see `signals/`, `features/`, `mcap/`, `bifurcations/`, `README.md`, `croissant.json`,
//! `sweep.yaml`, `SHA256SUMS` and `manifest.json`. Beside these there is `_sweep/`:
//!
//! | path | what |
//! |---|---|
//! | `plan.json` | the identity of the sweep |
//! | `commits/K.json` | shard K is finished |
//! | `attempts/` | the processes at work on each shard |
//! | `logs/` | what each process did, and when |
//! | `tmp/` | files that are being written |
//! | `lock`, `commit.lock` | see [`super::lock`] |
//!
//! A sweep that calibrates its machine keeps the calibration in `calibration/`. Its resolved sweep
//! names that folder, and every dataset that is made from it gets a copy.

use super::store::Store;
use crate::Error;

/// Which sweep it is.
pub(super) const PLAN: &str = "_sweep/plan.json";
pub(super) const CARD: &str = "README.md";
/// The same for programs.
pub(super) const CROISSANT: &str = "croissant.json";
pub(super) const SWEEP: &str = "sweep.yaml";
pub(super) const SUMS: &str = "SHA256SUMS";
pub(super) const MANIFEST: &str = "manifest.json";
/// What a dataset has in its folder, apart from `_sweep`.
pub(super) const FOLDERS: [&str; 4] = ["signals", "features", "mcap", DIAGRAMS];
pub(super) const FILES: [&str; 5] = [CARD, CROISSANT, SWEEP, SUMS, MANIFEST];
/// The records of finished shards.
pub(super) const COMMITS: &str = "_sweep/commits";
pub(super) const WORK: [&str; 4] = [COMMITS, ATTEMPTS, LOGS, "_sweep/tmp"];
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
