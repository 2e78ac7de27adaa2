//! One case: a machine file, recordings, and the clearances that they were made with.

use calibrate::likelihood::{Likelihood, misfit};
use calibrate::meter::Meter;
use calibrate::optimiser::{LeastSquares, Progress};
use calibrate::problem::columns;
use calibrate::run_condition::CRANK_ANGLE_OFFSET;
use calibrate::wear::{Results, estimate};
use calibrate::{CrankMotion, Observation, Parameter, Problem, Run, Stage, Watcher};
use input::{MachineFile, paths};
use serde_json::Value;
use std::collections::BTreeMap;
use std::error::Error;
use std::ops::ControlFlow;

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
    /// Whether the recorded motion repeats itself from revolution to revolution.
    pub repeats: bool,
    /// Processor time that it took, s.
    pub cpu_seconds: f64,
}

/// The case of a machine file `tree` and the recorded `runs`, whose stated clearances are not used.
pub fn case(
    name: String,
    mut tree: Value,
    mut runs: Vec<Run>,
    truth: BTreeMap<String, f64>,
) -> Result<Case, Box<dyn Error>> {
    let problem = problem(&mut tree, &mut runs)?;
    eprintln!("{name}: {truth:?}, {} runs", runs.len());
    let start = cpu_seconds()?;
    let results = estimate(&problem, &[0.0], WORN_FROM, &mut Lines::default())?;
    for (path, joint) in results.joints.iter() {
        eprintln!(
            "  {path}: {:?} {:?} {}",
            joint.verdict, joint.clearance_m, joint.reason
        );
    }
    Ok(Case {
        name,
        truth,
        results,
        runs: runs.len(),
        repeats: problem.runs.iter().all(|run| run.repeats_like(&[])),
        cpu_seconds: cpu_seconds()? - start,
    })
}

/// The misfit of the machine file `tree` itself, over the noise, and whether the motion of each run repeats itself.
pub fn seen(tree: &Value, runs: &[Run]) -> Result<(f64, Vec<bool>), Box<dyn Error>> {
    let problem = problem(&mut tree.clone(), &mut runs.to_vec())?;
    let repeats = problem.runs.iter().map(|run| run.repeats_like(&[]));
    let misfit = misfit(&Likelihood::new(&problem).residuals(&[0.0]));
    Ok((misfit, repeats.collect()))
}

fn problem(tree: &mut Value, runs: &mut [Run]) -> Result<Problem, Box<dyn Error>> {
    for run in runs.iter_mut() {
        run.settings
            .retain(|(path, _)| !path.ends_with(".clearance"));
    }
    for (path, value) in &runs[0].settings {
        paths::set(tree, path, value.clone())?;
    }
    let columns = columns(&MachineFile::from_tree(tree)?.resolve()?);
    let observed = runs.iter().map(|run| Observation::from_run(run, &columns));
    Ok(Problem {
        parameters: vec![Parameter::named(tree, &[], CRANK_ANGLE_OFFSET, None)?],
        runs: observed.collect::<Result<_, _>>()?,
        tree: tree.clone(),
        crank: CrankMotion::Driven,
        meter: Meter::default(),
    })
}

/// Processor time of this process, s, as Linux reports it in hundredths of a second (proc(5): user and
/// system time are the 14th and 15th field, and the 2nd, a name in brackets, may hold blanks).
fn cpu_seconds() -> Result<f64, Box<dyn Error>> {
    let text = std::fs::read_to_string("/proc/self/stat")?;
    let (_, fields) = text.rsplit_once(')').ok_or("no fields")?;
    let times = fields.split_whitespace().skip(11).take(2);
    let hundredths: f64 = times.map(|t| t.parse().unwrap_or(0.0)).sum();
    Ok(hundredths / 100.0)
}

/// A line on standard error after each stage.
#[derive(Default)]
struct Lines {
    stage: Option<Stage>,
    evaluations: u64,
    misfit: f64,
}

impl Watcher for Lines {
    fn begins(&mut self, stage: Stage, _: u64) {
        self.stage = Some(stage);
    }
    fn progress(&mut self, progress: &Progress) -> ControlFlow<()> {
        (self.evaluations, self.misfit) = (progress.evaluations, progress.misfit());
        ControlFlow::Continue(())
    }
    fn ends(&mut self) {
        let Self {
            stage,
            evaluations,
            misfit,
        } = self;
        eprintln!("  {stage:?}: {evaluations} evaluations, misfit {misfit:.2}");
    }
}
