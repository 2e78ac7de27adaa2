//! From settings to what is to be fitted to what.

mod bundles;
mod fingerprint;
mod fit_settings;
mod parameters;
mod relation;
mod settings;
mod stated_clearances;

pub use settings::Settings;

use crate::crank_motion::CrankMotion;
use crate::error::Error;
use crate::fit::FitSettings;
use crate::meter::Meter;
use crate::observation::{Observation, Run};
use crate::parameter::Parameter;
use crate::prediction::predict;
use crate::problem::{Problem, columns};
use crate::results::ByName;
use crate::run_condition::CRANK_ANGLE_OFFSET;
use crate::shut_valve::ShutValve;
use crate::{alignment, bundle, contradiction, zero};
use input::bundle_channel::Meaning;
use input::{MachineFile, paths};
use signal::crank_angle::CrankAngle;
use std::f64::consts::TAU;

/// Change of a run's zero of the crank angle that is worth another fit, rad: a tenth of the noise of
/// usual lines.
const ALIGNED: f64 = 1e-5;

/// Relative difference from which a measured speed takes the place of the stated one. An encoder
/// determines it better than a recording's other errors.
const SPEED: f64 = 2e-5;

/// What a calibration works on.
pub struct Task {
    /// What is fitted to what.
    pub problem: Problem,
    /// The runs, in the same order, as they were recorded.
    pub runs: Vec<Run>,
    /// How it is fitted.
    pub settings: FitSettings,
    /// For each run whether the zero of its crank angle was recorded.
    pub zeroed: Vec<bool>,
    /// For each run by how much the crank angle was raised to align it, rad.
    turned: Vec<f64>,
    /// For each run whether a tacho of unknown place gave the crank angle.
    pulsed: Vec<bool>,
    /// For each run whether an encoder gave the crank angle.
    pub encoded: Vec<bool>,
    /// The valves that recorded pressures do not open.
    pub shut_valves: Vec<ShutValve>,
    /// The columns that the machine has.
    columns: Vec<String>,
}

/// The task that the settings state.
///
/// # Errors
/// Settings, a machine or runs that cannot be used or contradict each other.
pub fn task(settings: &Settings) -> Result<Task, Error> {
    let asked = settings.calibration;
    let bundles = bundles::read(settings)?;
    let machine = asked.machine.as_ref().map(|path| settings.base.join(path));
    let mut tree = match settings.machine {
        Some(tree) => tree.clone(),
        None => bundle::machine(&bundles[0].bundle, machine.as_deref())?,
    };
    let mut runs = Vec::new();
    let mut zeroed = Vec::new();
    let mut encoded = Vec::new();
    let mut pulsed = Vec::new();
    for listed in &bundles {
        for (run, meanings) in listed.runs(settings, &tree)? {
            let any = |wanted: fn(&Meaning) -> bool| meanings.iter().any(wanted);
            zeroed.push(any(|m| {
                matches!(m, Meaning::CrankAngle(_) | Meaning::Tacho { at: Some(_) })
            }));
            encoded.push(any(|m| matches!(m, Meaning::CrankAngle(_))));
            let is_pulsed = any(|m| matches!(m, Meaning::Tacho { at: None }));
            pulsed.push(is_pulsed && zeroed.last() == Some(&false));
            runs.push(run);
        }
    }
    if settings.clearances_unknown {
        stated_clearances::pass_over(&mut runs)?;
    }
    let free = tree["crank"]["drive"]["free"].is_object();
    for run in &mut runs {
        turn(run, free)?;
    }
    let Some(first) = runs.first() else {
        return Err(Error::Refused("every run is left out".into()));
    };
    // The machine stands at the conditions of the first run where it has none of its own.
    for (path, value) in &first.settings {
        paths::set(&mut tree, path, value.clone())?;
    }
    let fit_settings = fit_settings::with_defaults(settings, &tree, &runs)?;
    let exponents = relation::set(settings, &mut tree, &runs, &fit_settings.held_out)?;
    let source = machine.unwrap_or_else(|| bundles[0].bundle.folder.join(input::bundle::FILE));
    let resolved = MachineFile::from_tree(&tree).and_then(|file| file.resolve());
    let resolved =
        resolved.map_err(|error| Error::Refused(format!("{}: {error}", source.display())))?;
    let mut parameters = parameters::fitted(settings, &tree, &runs)?;
    for exponent in exponents {
        let free = |place: &String| parameters.iter().any(|p| p.places.contains(place));
        if !exponent.places.iter().any(free) {
            parameters.push(exponent);
        }
    }
    let mut task = Task {
        settings: fit_settings,
        problem: Problem {
            tree,
            parameters,
            runs: Vec::new(),
            crank: CrankMotion::Driven,
            meter: Meter::default(),
        },
        turned: vec![0.0; runs.len()],
        runs,
        zeroed,
        pulsed,
        encoded,
        shut_valves: Vec::new(),
        columns: columns(&resolved),
    };
    task.observe()?;
    if asked.parameters.0.is_empty() {
        task.leave_out_unseen_lines();
    }
    Ok(task)
}

impl Task {
    /// Looks at all runs, and holds them against the nominal machine.
    fn observe(&mut self) -> Result<(), Error> {
        let seen = self.runs.iter().map(|run| observe(run, &self.columns));
        self.problem.runs = seen.collect::<Result<_, _>>()?;
        let nominal = vec![0.0; self.problem.parameters.len()];
        self.align_first(&nominal)?;
        let start = self.start_at_zero()?;
        self.shut_valves = contradiction::check(&self.problem, start.as_ref().unwrap_or(&nominal))?;
        self.settings.start = start;
        Ok(())
    }

    /// Refuses pressures without a mean, unless the machine states what their sensors pass. What looks for that needs them.
    ///
    /// # Errors
    /// The first channel that is so; an invalid machine.
    pub fn refuse_without_mean(&self) -> Result<(), Error> {
        let nominal = vec![0.0; self.problem.parameters.len()];
        contradiction::refuse_without_mean(&self.problem, &nominal)
    }

    /// Takes the pressures of discharge lines that no recording shows as they are stated.
    fn leave_out_unseen_lines(&mut self) {
        let unseen = parameters::unseen_lines(&self.runs, &self.shut_valves);
        let parameters = std::mem::take(&mut self.problem.parameters);
        let is_seen = |parameter: &Parameter| !unseen.contains(&parameter.path);
        if let Some(start) = &mut self.settings.start {
            let mut parameters = parameters.iter();
            start.retain(|_| parameters.next().is_none_or(is_seen));
        }
        self.problem.parameters = parameters.into_iter().filter(is_seen).collect();
    }

    /// Where the search starts if the recorded zero of the crank angle is nowhere near top dead centre. The bounds of
    /// the offset are opened that far. Pressures alone have no offset among what is fitted: they get one then.
    fn start_at_zero(&mut self) -> Result<Option<Vec<f64>>, Error> {
        let is_offset = Parameter::is_crank_angle_offset;
        if !self.problem.parameters.iter().any(is_offset) {
            let offset =
                Parameter::named(&self.problem.tree, &self.runs, CRANK_ANGLE_OFFSET, None)?;
            let seen = zero::crank_angle_offset(&self.problem, |_| true)?;
            if !seen.is_some_and(|seen| offset.clone().open_for_offset(seen)) {
                return Ok(None);
            }
            self.problem.parameters.push(offset);
        }
        let mut start = vec![0.0; self.problem.parameters.len()];
        let mut starts = false;
        let of_all = |p: &Parameter| is_offset(p) && p.run.is_none();
        let has_common = self.problem.parameters.iter().any(of_all);
        for (i, start) in start.iter_mut().enumerate() {
            let parameter = &self.problem.parameters[i];
            if !is_offset(parameter) || has_common && parameter.run.is_some() {
                continue;
            }
            let holds = |run: &Observation| parameter.holds_in(&run.id);
            let Some(offset) = zero::crank_angle_offset(&self.problem, holds)? else {
                continue;
            };
            let parameter = &mut self.problem.parameters[i];
            if parameter.open_for_offset(offset) {
                *start = parameter.coordinate(offset);
                starts = true;
            }
        }
        Ok(starts.then_some(start))
    }

    /// Aligns the runs whose zero was not recorded with the nominal machine, where they show it.
    fn align_first(&mut self, nominal: &[f64]) -> Result<(), Error> {
        for i in 0..self.runs.len() {
            if self.zeroed[i] {
                continue;
            }
            let run = &self.problem.runs[i];
            let predicted = predict(&self.problem, run, nominal)?;
            let found = alignment::zero(&[(run, &predicted)]);
            let Some(rival) = found.rival else {
                self.raise(i, found.raised)?;
                continue;
            };
            let at = [found.raised, rival].map(|at| at.to_degrees().rem_euclid(360.0));
            let where_to = match self.pulsed[i] {
                true => "the pulse of the tacho",
                false => "the first sample",
            };
            return Err(Error::unusable(
                &run.id,
                format!(
                    "its channels do not show where the crank stands: {where_to} may be at {:.0}° or at {:.0}° after top dead \
                     centre. A cylinder pressure shows it, or crank_angle_rad at the channel of a tacho",
                    at[0], at[1]
                ),
            ));
        }
        Ok(())
    }

    /// Raises the crank angle of a run, rad, and looks at it anew.
    fn raise(&mut self, i: usize, shift: f64) -> Result<(), Error> {
        for angle in self.runs[i].crank_angle.iter_mut().flatten() {
            *angle = (*angle + shift).rem_euclid(TAU);
        }
        self.turned[i] += shift;
        self.problem.runs[i] = observe(&self.runs[i], &self.columns)?;
        Ok(())
    }

    /// The crank angle, rad in [0, 2π), to which the pulse of each tacho was aligned whose place was not known, by run. What is
    /// fitted as its offset comes off it.
    pub fn pulse_angles(&self) -> impl Iterator<Item = (&str, f64)> {
        let runs = self.runs.iter().zip(&self.pulsed).zip(&self.turned);
        let pulsed = runs.filter(|((_, pulsed), _)| **pulsed);
        pulsed.map(|((run, _), turned)| (run.id.as_str(), turned.rem_euclid(TAU)))
    }

    /// The crank angle at which these pulses come, by run, rad in [0, 2π): with the offsets of `problem` at the coordinates `x`.
    pub(crate) fn pulses(&self, problem: &Problem, x: &[f64]) -> ByName<f64> {
        let found = self.pulse_angles().filter_map(|(id, aligned)| {
            let run = problem.runs.iter().find(|run| run.id == id)?;
            let angle = aligned - problem.crank_angle_offset(run, x).0;
            Some((id.to_owned(), angle.rem_euclid(TAU)))
        });
        found.collect()
    }

    /// Aligns the crank angle of every run whose zero was not recorded with the prediction of the machine, with the
    /// parameters at `x`. Returns whether that has moved one.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn align(&mut self, x: &[f64]) -> Result<bool, Error> {
        let mut moved = false;
        for i in (0..self.runs.len())
            .filter(|i| !self.zeroed[*i])
            .collect::<Vec<_>>()
        {
            let observed = &self.problem.runs[i];
            let predicted = predict(&self.problem, observed, x)?;
            let shift = alignment::phase(observed, &predicted);
            if shift.abs() < ALIGNED {
                continue;
            }
            moved = true;
            self.raise(i, shift)?;
        }
        Ok(moved)
    }
}

/// Gives a run the speed at which it turns, and a crank angle of that speed where it has none.
fn turn(run: &mut Run, free: bool) -> Result<(), Error> {
    let measured = match &run.crank_angle {
        Some(angle) => {
            let angle = CrankAngle::from_encoder(angle);
            let angle = angle.map_err(|error| Error::unusable(&run.id, error))?;
            60.0 * run.sample_rate / angle.samples_per_revolution()
        }
        None => alignment::speed(run),
    };
    contradiction::speed(run, measured)?;
    if run.crank_angle.is_none() {
        let step = TAU * measured / 60.0 / run.sample_rate;
        let samples = run.channels.first().map_or(0, |c| c.samples.len());
        let angles = (0..samples).map(|i| (step * i as f64).rem_euclid(TAU));
        run.crank_angle = Some(angles.collect());
    }
    // A free crank's setting is another speed, that of its motor's torque.
    if !free && (measured / run.speed_rpm - 1.0).abs() > SPEED {
        run.speed_rpm = measured;
        for (_, value) in run.settings.iter_mut().filter(|(path, _)| path == "speed") {
            *value = format!("{measured} rpm").into();
        }
    }
    Ok(())
}

fn observe(run: &Run, columns: &[String]) -> Result<Observation, Error> {
    Observation::from_run(run, columns).map_err(|error| Error::unusable(&run.id, error))
}
