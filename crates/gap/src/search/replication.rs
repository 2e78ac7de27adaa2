//! Whether an effect shows again in every recording: what stands in for prediction where no run can be
//! held out.
//!
//! Of a few recordings of pressures alone one may be off by itself, and what one effect does to it
//! is easily done by another. What is true of the machine has to show at each of them.

use crate::candidate::Candidate;
use crate::criteria::EARNED_OF_GAS;
use crate::model::Model;
use crate::recorded::is_of_pressures;
use calibrate::Observation;

/// Share of a run's squared misfit that an effect has to take, of what it has to take of all.
const IN_EACH: f64 = 0.5;

/// Whether `candidate`, which `after` has and `before` has not, makes every run better that it acts on.
/// Always true where runs are held out, and where not only pressures were recorded.
pub(crate) fn shows_in_each(candidate: &Candidate, before: &Model, after: &Model) -> bool {
    if after.held_out.is_some() || !is_of_pressures(&after.problem) {
        return true;
    }
    let runs = after.problem.runs.iter().zip(&after.by_run);
    runs.filter(|(run, _)| acts_on(candidate, run))
        .all(|(run, after)| {
            let same = before
                .problem
                .runs
                .iter()
                .position(|other| other.id == run.id);
            same.is_none_or(|i| {
                let excess = |misfit: f64| (misfit * misfit - 1.0).max(0.0);
                excess(*after) <= (1.0 - IN_EACH * EARNED_OF_GAS) * excess(before.by_run[i])
            })
        })
}

/// Whether a run shows the end of the cylinder at which a candidate acts.
fn acts_on(candidate: &Candidate, run: &Observation) -> bool {
    let at = |column: &str| match column.contains("crank_end") {
        true => "crank",
        false => "head",
    };
    let mut columns = run.channels.iter().map(|channel| channel.column.as_str());
    candidate
        .end()
        .is_none_or(|end| columns.any(|column| at(column) == end))
}
