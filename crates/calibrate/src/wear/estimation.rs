//! An estimation of wear, from recordings to the files of its results.

use super::descent;
use super::discrepancy::{Discrepancy, discrepancy};
use super::effort::Effort;
use super::joint::Joint;
use super::model::Contacts;
use super::results::{Contact, Interval, Misfits, Results, RunMisfit, WEAR};
use super::selection::{Found, selected};
use super::tolerance::widen;
use super::verdict::{Grounds, together};
use crate::comparison::compare_models;
use crate::earlier::{self, Existing, Outcome};
use crate::error::Error;
use crate::fit::RunFit;
use crate::likelihood::{Likelihood, misfit};
use crate::meter::Meter;
use crate::observation::Observation;
use crate::pictures;
use crate::problem::Problem;
use crate::results::{ByName, Estimate, MACHINE};
use crate::stages::{ALIGNMENTS, Stage, Watcher};
use crate::task::{Settings, Task, task};
use input::MachineFile;
use recordings::WholeFile;
use std::path::{Path, PathBuf};

/// What is asked for.
pub struct Asked<'a> {
    /// The bundle and the machine file. The clearances of the bundle are passed over.
    pub settings: Settings<'a>,
    /// A joint counts as worn from this many times its normal clearance.
    pub worn_from: f64,
}

/// An estimation whose input has been read and found to be usable.
pub struct Prepared {
    task: Task,
    joints: Vec<Joint>,
    worn_from: f64,
    fingerprint: String,
    out: PathBuf,
    existing: Existing,
    earlier: Option<Results>,
}

/// An estimation that is on the disk.
#[derive(Clone, Debug)]
pub struct Estimated {
    /// The machine file with the clearances that were found.
    pub machine: PathBuf,
    /// The content of `wear.json`.
    pub results: Results,
    /// True where it was there before, and nothing was to be done.
    pub reused: bool,
}

/// Reads everything that an estimation into the folder `out` needs, and what is there of it already. Nothing is written.
///
/// # Errors
/// A bundle, a machine or recordings that cannot be used or contradict each other, a machine without joints that may be
/// worn, recordings without a channel that shows clearances, or a folder that is in the way.
pub fn prepare(asked: &Asked, out: &Path, existing: Existing) -> Result<Prepared, Error> {
    earlier::check_folder::<Results>(out, existing)?;
    let task = task(&asked.settings)?;
    task.refuse_without_mean()?;
    let joints = Joint::of_machine(&task.problem.tree)?;
    if joints.is_empty() {
        return Err(Error::Refused(
            "the machine file has no joint that may be worn: big_end, small_end, guide or main in `joints` needs a \
             section with a clearance (or 'ideal'), a size and a contact law"
                .into(),
        ));
    }
    for run in &task.problem.runs {
        if run.channels.iter().all(|c| c.quantity().is_pressure()) {
            return Err(Error::unusable(
                &run.id,
                "no channel shows clearances: an acceleration is needed. That of the crosshead needs no more; for one of the \
                 frame or of a guide the machine file has a section frame or housing",
            ));
        }
    }
    let fingerprint = format!("{} worn from {}", task.fingerprint(), asked.worn_from);
    Ok(Prepared {
        earlier: earlier::read_existing(out, existing, &fingerprint)?,
        task,
        joints,
        worn_from: asked.worn_from,
        fingerprint,
        out: out.to_owned(),
        existing,
    })
}

impl Prepared {
    /// Estimates the clearances, unless that is done, and writes `wear.json`, the machine file with them, and what pictures
    /// are drawn from. Where `watcher` stops the search, the best so far is written, marked as incomplete. Each evaluation is
    /// written to the disk at once: an estimation that was stopped or killed continues from there, and ends with the same results.
    ///
    /// # Errors
    /// A machine that cannot be simulated, or files that cannot be written.
    pub fn finish(mut self, watcher: &mut dyn Watcher) -> Result<Estimated, Error> {
        let machine = self.out.join(MACHINE);
        if let Some(results) = self.earlier.take_if(|earlier| earlier.is_complete()) {
            return Ok(Estimated {
                machine,
                results,
                reused: true,
            });
        }
        let checkpoint = earlier::checkpoint(&self.out, self.existing, &self.fingerprint)?;
        self.task.problem.meter = Meter::with_checkpoint(checkpoint);
        let mut effort = Effort::new(watcher);
        let (healthy, scattering) = compared(&self.task.problem);
        let x = start(&self.task);
        let mut found = selected(&healthy, &self.joints, &x, &mut effort)?;
        self.align(&mut found, &mut effort)?;
        // The healthy machine is held against the aligned runs.
        let healthy = Problem {
            runs: found.model.problem.runs.clone(),
            ..healthy
        };
        let mut concluded = conclude(
            &healthy,
            &x,
            &self.joints,
            &mut found,
            self.worn_from,
            &mut effort,
        )?;
        let problem = &found.model.problem;
        concluded.results.scattering_runs = scattering;
        concluded.results.pulse_angles_rad = self.task.pulses(problem, &concluded.x);
        concluded.results.fingerprint.clone_from(&self.fingerprint);
        let models = [(&healthy, &x[..]), (problem, &concluded.x[..])];
        pictures::write(&self.out, &compare_models(models, &self.task.runs)?)?;
        let tree = problem.fitted(&concluded.x)?;
        let text = MachineFile::from_tree(&tree).and_then(|file| file.to_yaml())?;
        WholeFile::write(&machine, &text)?;
        // What makes the folder whole comes last.
        let path = self.out.join(WEAR);
        let text = serde_json::to_string_pretty(&concluded.results);
        let text = text.map_err(|error| Error::file(&path, error))?;
        WholeFile::write(&path, &text)?;
        if concluded.results.complete {
            earlier::remove_checkpoint(&self.out)?;
        }
        Ok(Estimated {
            machine,
            results: concluded.results,
            reused: false,
        })
    }

    /// Aligns runs without a recorded zero of the crank angle with the worn machine, and fits again.
    fn align(&mut self, found: &mut Found, effort: &mut Effort) -> Result<(), Error> {
        for _ in 0..ALIGNMENTS {
            let x = found.fit.coordinates();
            self.task.problem = Problem {
                runs: std::mem::take(&mut self.task.problem.runs),
                ..found.model.problem.clone()
            };
            self.task.problem.take_over_branches(&found.model.problem);
            if effort.stopped || !self.task.zeroed.contains(&false) || !self.task.align(&x)? {
                break;
            }
            found.model.problem = compared(&self.task.problem).0;
            effort.begins(Stage::Clearances);
            let fit = descent::fit(&mut found.model, x, effort);
            effort.ends();
            found.fit = fit?;
        }
        Ok(())
    }
}

/// Estimates the clearances of the machine that the runs of `healthy` are of; its parameters are what else is unknown, at
/// the coordinates `x` to begin with.
///
/// # Errors
/// A machine that cannot be simulated.
pub fn estimate(
    healthy: &Problem,
    x: &[f64],
    worn_from: f64,
    watcher: &mut dyn Watcher,
) -> Result<Results, Error> {
    let mut effort = Effort::new(watcher);
    let joints = Joint::of_machine(&healthy.tree)?;
    let (healthy, scattering) = compared(healthy);
    let mut found = selected(&healthy, &joints, x, &mut effort)?;
    let mut concluded = conclude(&healthy, x, &joints, &mut found, worn_from, &mut effort)?;
    concluded.results.scattering_runs = scattering;
    Ok(concluded.results)
}

/// A problem with the runs that are compared, and the others by name: where the motion of some runs repeats itself, these
/// determine the clearances much better than the means of those that scatter.
fn compared(problem: &Problem) -> (Problem, Vec<String>) {
    let runs = problem.runs.iter();
    let (repeating, scattering): (Vec<&Observation>, Vec<_>) = runs.partition(|run| run.repeats());
    if repeating.is_empty() {
        return (problem.clone(), Vec::new());
    }
    let scattering = scattering.iter().map(|run| run.id.clone()).collect();
    (problem.with_runs(Observation::repeats), scattering)
}

/// Where the search starts in what else is unknown.
fn start(task: &Task) -> Vec<f64> {
    let nominal = vec![0.0; task.problem.parameters.len()];
    task.settings.start.clone().unwrap_or(nominal)
}

/// The results, and the coordinates that they are at.
struct Concluded {
    results: Results,
    x: Vec<f64>,
}

fn conclude(
    healthy: &Problem,
    x: &[f64],
    joints: &[Joint],
    found: &mut Found,
    worn_from: f64,
    effort: &mut Effort,
) -> Result<Concluded, Error> {
    let recorded = found.model.problem.runs.iter().all(Observation::repeats);
    let repeats = recorded && descent::repeats(&found.model.problem, &found.fit.coordinates());
    widen(joints, found, repeats);
    let fit = &found.fit;
    let problem = &found.model.problem;
    let whole = fit.complete && !effort.stopped;
    let adequate = fit.model_is_adequate();
    // An adequate model may leave more than noise, and then the noise alone is no measure of what is known.
    let wrong = match whole && repeats && !fit.is_at_noise() {
        true => discrepancy(problem, fit, effort)?,
        false => None,
    };
    let discrepancy = wrong.as_ref();
    let pairs = together(joints, found, repeats);
    let grounds = Grounds {
        healthy,
        joints,
        found,
        discrepancy,
        complete: whole,
        worn_from,
    };
    let verdicts = (0..joints.len())
        .map(|i| Ok((joints[i].path.clone(), grounds.verdict(i, &pairs)?)))
        .collect::<Result<_, Error>>()?;
    let before = Likelihood::new(healthy).by_run(x)?;
    let runs = fit.runs.iter().zip(&before);
    let runs = runs.map(|(run, before): (&RunFit, _)| {
        let misfits = RunMisfit {
            healthy: misfit(before),
            estimated: run.calibrated,
        };
        (run.id.clone(), misfits)
    });
    let others = fit.estimates.iter().skip(found.model.clear.len());
    let results = Results {
        complete: whole,
        fingerprint: String::new(),
        evaluations: effort.spent,
        worn_from,
        joints: verdicts,
        together: pairs,
        model_is_adequate: adequate,
        interval: match discrepancy {
            Some(_) => Interval::Discrepancy,
            None if !adequate || !whole => Interval::None,
            None if repeats => Interval::Noise,
            None => Interval::Scatter,
        },
        timing_rad: discrepancy.map(|d| d.timing),
        contact: match found.model.contacts {
            Contacts::Stated => Contact::MachineFile,
            Contacts::Related | Contacts::Fitted => Contact::Fitted,
        },
        fit: Misfits {
            unit: "standard deviations of the synchronous mean's noise".to_owned(),
            noise_floor: 1.0,
            healthy: misfit(&before.concat()),
            estimated: found.misfit(),
        },
        runs: runs.collect(),
        scattering_runs: Vec::new(),
        pulse_angles_rad: ByName::default(),
        channels: channels(problem),
        parameters: others
            .map(|e| (e.parameter.path.clone(), Estimate::from_fit(e, adequate)))
            .collect(),
    };
    let x = discrepancy.map_or_else(|| fit.coordinates(), |d: &Discrepancy| d.x.clone());
    Ok(Concluded { results, x })
}

/// The columns that were compared, each once.
fn channels(problem: &Problem) -> Vec<String> {
    let mut columns: Vec<String> = Vec::new();
    for channel in problem.runs.iter().flat_map(|run| &run.channels) {
        if !columns.contains(&channel.column) {
            columns.push(channel.column.clone());
        }
    }
    columns
}
