//! What is printed of a dataset: its size, its labels, and the cases that failed.

use recordings::{CaseWarning, FailedCase, Manifest};
use std::path::Path;
use sweep::{Census, Plan};

/// Failed cases that are shown.
const SHOWN_FAILURES: usize = 5;

/// Says what is wrong.
pub(crate) fn warn(warnings: &[String]) {
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
}

/// Prints what a finished dataset has, and says what is wrong with its labels beside the mistakes that
/// were printed when it was begun.
pub(crate) fn summarise(plan: &Plan, manifest: &Manifest, out: &Path, seconds: f64) {
    let bytes: u64 = manifest.files.iter().map(|file| file.bytes).sum();
    let rows: u64 = manifest
        .counts
        .rows
        .values()
        .flat_map(|of| of.values())
        .sum();
    println!(
        "{}: {} cases, {rows} rows, {} files, {:.1} MB in {seconds:.1} s",
        out.display(),
        manifest.counts.cases,
        // With the manifest and SHA256SUMS.
        manifest.files.len() + 2,
        bytes as f64 / 1e6
    );
    let census = Census::from_manifest(plan, manifest);
    println!("{census}");
    let mut warnings = census.warnings();
    let printed = plan.census().mistakes();
    warnings.retain(|warning| !printed.contains(warning));
    warn(&warnings);
    if let Some(text) = doubtful(&manifest.warnings) {
        println!("{text}");
    }
}

/// What is doubtful about cases, if anything is: the first few.
fn doubtful(all: &[CaseWarning]) -> Option<String> {
    if all.is_empty() {
        return None;
    }
    let mut text = format!("warnings: {}", all.len());
    for CaseWarning { case_id, warning } in all.iter().take(SHOWN_FAILURES) {
        text += &format!("\n  {case_id}: {warning}");
    }
    if all.len() > SHOWN_FAILURES {
        let more = all.len() - SHOWN_FAILURES;
        text += &format!("\n  and {more} more, in `warnings` of manifest.json");
    }
    Some(text)
}

/// What is to be said of the cases that failed, if any did: the first few, each with the command that
/// runs it again.
pub(crate) fn failures(failed: &[FailedCase], cases: u64, out: &Path) -> Option<String> {
    if failed.is_empty() {
        return None;
    }
    let mut text = format!("{} of {cases} cases failed:", failed.len());
    for case in failed.iter().take(SHOWN_FAILURES) {
        let (id, reason, again) = (&case.case_id, &case.reason, case.command_in(out));
        text += &format!("\n  {id}: {reason}\n    again: {again}");
    }
    if failed.len() > SHOWN_FAILURES {
        let more = failed.len() - SHOWN_FAILURES;
        text += &format!("\n  and {more} more, in `failed` of manifest.json and in _sweep/logs");
    }
    Some(text)
}
