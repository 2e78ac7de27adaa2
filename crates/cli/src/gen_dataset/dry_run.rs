//! `gen-dataset --dry-run`.

use crate::Failure;
use crate::output::warn;
use std::path::Path;
use sweep::plan::MOST_CASES;
use sweep::{Plan, Sweep};

/// Says how large the dataset will be and how long it will take, from a few simulated cases.
pub(super) fn run(plan: &Plan) -> Result<(), Failure> {
    let estimate = plan.estimate();
    println!("{}: {estimate}\n{}", plan.name, plan.census());
    warn(&plan.census().warnings());
    let timing = plan.time_cases()?;
    println!(
        "time: {:.0} s on one core, measured on {} cases ({:.2} s each)",
        timing.all_s,
        timing.sampled,
        timing.sample_s / timing.sampled
    );
    let diagrams = plan.estimate_diagrams();
    if diagrams.diagrams > 0 {
        println!("{diagrams}");
        let timing = plan.time_diagrams()?;
        println!(
            "time: {:.0} s more on one core, measured on {} revolutions",
            timing.all_s, timing.sampled
        );
    }
    if estimate.cases > MOST_CASES {
        println!("a dataset can have at most {MOST_CASES} cases: this sweep will be refused");
    }
    Ok(())
}

/// The plan as far as it is known without calibrating anything.
pub(super) fn planned(sweep: &Sweep, nominal: Plan, out: &Path) -> Result<Plan, Failure> {
    if sweep.calibrate().is_none() {
        return Ok(nominal);
    }
    let kept = sweep.plan_if_kept(out)?;
    println!(
        "{}",
        match kept {
            Some(_) => "calibrated before, and nothing has changed since",
            None =>
                "the machine would be calibrated first; what follows is for the nominal one, without its \
                 uncertainty",
        }
    );
    Ok(kept.unwrap_or(nominal))
}
