//! `gen-dataset --dry-run`.

use super::summary::warn;
use crate::Failure;
use sweep::Plan;

/// Says how large the dataset will be and how long it will take, from a few simulated cases.
pub(super) fn dry_run(plan: &Plan) -> Result<(), Failure> {
    let estimate = plan.estimate();
    println!(
        "{}: {} cases, {} rows, {} shards, {:.0} revolutions to simulate",
        plan.name, estimate.cases, estimate.rows, estimate.shards, estimate.revolutions
    );
    println!(
        "recordings before compression: {:.1} MB",
        estimate.bytes / 1e6
    );
    println!("{}", plan.census());
    warn(&plan.census().warnings());
    let timing = plan.time_cases()?;
    println!(
        "time: {:.0} s on one core, measured on {} cases ({:.2} s each)",
        timing.all_s,
        timing.sampled,
        timing.sample_s / timing.sampled
    );
    dry_run_diagrams(plan)?;
    if estimate.cases > sweep::plan::MOST_CASES {
        println!(
            "a dataset can have at most {} cases: this sweep will be refused",
            sweep::plan::MOST_CASES
        );
    }
    Ok(())
}

/// The same for the bifurcation diagrams, from a few revolutions of each.
fn dry_run_diagrams(plan: &Plan) -> Result<(), Failure> {
    let estimate = plan.estimate_diagrams();
    if estimate.diagrams == 0 {
        return Ok(());
    }
    println!(
        "bifurcation diagrams: {}, {} values, {} revolutions to simulate, {:.1} MB before compression",
        estimate.diagrams,
        estimate.values,
        estimate.revolutions,
        estimate.bytes / 1e6
    );
    let timing = plan.time_diagrams()?;
    println!(
        "time: {:.0} s more on one core, measured on {} revolutions",
        timing.all_s, timing.sampled
    );
    Ok(())
}
