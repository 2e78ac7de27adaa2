//! Clearances that runs state, where they are what is asked for.

use crate::error::Error;
use crate::observation::Run;
use serde_json::Value;

/// Takes the stated clearances out of the runs.
///
/// # Errors
/// Runs that state different clearances are of different states of the machine.
pub(super) fn pass_over(runs: &mut [Run]) -> Result<(), Error> {
    for run in runs.iter().skip(1) {
        let first = &runs[0];
        let [of_first, of_run] = [first, run].map(stated);
        if let Some((path, value)) = of_run.iter().find(|stated| !of_first.contains(stated)) {
            let other = of_first.iter().find(|(other, _)| other == path);
            let other = other.map_or("nothing".to_owned(), |(_, value)| value.to_string());
            return Err(Error::Refused(format!(
                "run {} states {path} as {value} and run {} as {other}: runs of one state of the machine are needed; \
                 --leave-out {} goes on without that run",
                run.id, first.id, run.id
            )));
        }
    }
    for run in runs {
        run.settings.retain(|(path, _)| !is_clearance(path));
    }
    Ok(())
}

fn stated(run: &Run) -> Vec<(&str, &Value)> {
    let settings = run.settings.iter();
    let clearances = settings.filter(|(path, _)| is_clearance(path));
    clearances
        .map(|(path, value)| (path.as_str(), value))
        .collect()
}

fn is_clearance(path: &str) -> bool {
    path.contains("joints.") && path.ends_with(".clearance")
}
