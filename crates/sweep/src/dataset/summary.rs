//! A finished dataset in a few lines of text: its size, its labels, and the cases that failed.

use crate::plan::{Census, Plan};
use recordings::{CaseWarning, FailedCase, Manifest};
use std::fmt::Write;
use std::path::Path;

/// Cases that are named.
const FIRST_FEW: usize = 5;

/// What the dataset in the folder `out`, made in so many seconds, has.
pub fn finished(plan: &Plan, manifest: &Manifest, out: &Path, seconds: f64) -> String {
    let counts = &manifest.counts;
    let rows: u64 = counts.rows.values().flat_map(|of| of.values()).sum();
    let bytes: u64 = manifest.files.iter().map(|file| file.bytes).sum();
    format!(
        "{}: {} cases, {rows} rows, {} files, {:.1} MB in {seconds:.1} s\n{}\n",
        out.display(),
        counts.cases,
        // With the manifest and SHA256SUMS.
        manifest.files.len() + 2,
        bytes as f64 / 1e6,
        Census::from_manifest(plan, manifest)
    )
}

/// What is wrong with the labels of a finished dataset beside the mistakes that its plan has shown.
pub fn late_warnings(plan: &Plan, manifest: &Manifest) -> Vec<String> {
    let known = plan.census().mistakes();
    let mut warnings = Census::from_manifest(plan, manifest).warnings();
    warnings.retain(|warning| !known.contains(warning));
    warnings
}

/// What is doubtful about cases, if anything is: the first few.
pub fn doubtful(all: &[CaseWarning]) -> Option<String> {
    let line = |case: &CaseWarning| format!("{}: {}", case.case_id, case.warning);
    let head = format!("warnings: {}", all.len());
    first_few(head, all, line, "`warnings` of manifest.json")
}

/// What is to be said of the cases that failed, if any did: the first few, each with the command that
/// runs it again.
pub fn failures(failed: &[FailedCase], cases: u64, out: &Path) -> Option<String> {
    let line = |case: &FailedCase| {
        let (id, reason, again) = (&case.case_id, &case.reason, case.command_in(out));
        format!("{id}: {reason}\n    again: {again}")
    };
    let head = format!("{} of {cases} cases failed:", failed.len());
    first_few(
        head,
        failed,
        line,
        "`failed` of manifest.json and in _sweep/logs",
    )
}

fn first_few<T>(
    head: String,
    all: &[T],
    line: impl Fn(&T) -> String,
    others: &str,
) -> Option<String> {
    let few = all.iter().take(FIRST_FEW);
    let mut text = few.fold(head, |text, one| text + "\n  " + &line(one));
    if all.len() > FIRST_FEW {
        // A string takes all that is written to it.
        let _ = write!(text, "\n  and {} more, in {others}", all.len() - FIRST_FEW);
    }
    (!all.is_empty()).then_some(text)
}
