//! One case: a machine file, recordings, and the clearances that they were made with.

use calibrate::meter::Meter;
use calibrate::optimiser::Progress;
use calibrate::problem::columns;
use calibrate::run_condition::CRANK_ANGLE_OFFSET;
use calibrate::wear::{Results, estimate};
use calibrate::{CrankMotion, Observation, Parameter, Problem, Run, Stage, Watcher};
use input::{MachineFile, paths};
use serde_json::Value;
use std::collections::BTreeMap;
use std::error::Error;
use std::ops::ControlFlow;
use std::time::Instant;

/// A joint counts as worn from this many times its normal clearance.
pub const WORN_FROM: f64 = 1.5;

/// A case with what was found in it.
pub struct Case {
    /// Its name.
    pub name: String,
    /// True clearance of each joint, m; 0 where it is ideal.
    pub truth: BTreeMap<String, f64>,
    /// What was found.
    pub results: Results,
    /// Runs that were compared.
    pub runs: usize,
    /// Time that it took, s.
    pub seconds: f64,
}

/// The case of a machine file `tree` and the recorded `runs`, whose stated clearances are not used.
pub fn case(
    name: String,
    mut tree: Value,
    mut runs: Vec<Run>,
    truth: BTreeMap<String, f64>,
) -> Result<Case, Box<dyn Error>> {
    for run in &mut runs {
        run.settings
            .retain(|(path, _)| !path.ends_with(".clearance"));
    }
    for (path, value) in &runs[0].settings {
        paths::set(&mut tree, path, value.clone())?;
    }
    let columns = columns(&MachineFile::from_tree(&tree)?.resolve()?);
    let observed = runs.iter().map(|run| Observation::from_run(run, &columns));
    let problem = Problem {
        parameters: vec![Parameter::named(&tree, &[], CRANK_ANGLE_OFFSET, None)?],
        runs: observed.collect::<Result<_, _>>()?,
        tree,
        crank: CrankMotion::Driven,
        meter: Meter::default(),
    };
    eprintln!("{name}: {truth:?}, {} runs", runs.len());
    let start = Instant::now();
    let results = estimate(&problem, &[0.0], WORN_FROM, &mut Quiet)?;
    Ok(Case {
        name,
        truth,
        results,
        runs: runs.len(),
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// Nobody watches.
struct Quiet;

impl Watcher for Quiet {
    fn begins(&mut self, _: Stage, _: u64) {}
    fn progress(&mut self, _: &Progress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
    fn ends(&mut self) {}
}
