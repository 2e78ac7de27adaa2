//! From settings to what is to be fitted to what.

use super::{Settings, contradiction, relation};
use crate::{Failure, bundle};
use ::calibrate::fit::{FitSettings, Optimiser};
use ::calibrate::optimiser::Genetic;
use ::calibrate::prediction::predict;
use ::calibrate::problem::columns;
use ::calibrate::relation::clearances;
use ::calibrate::run_condition::CRANK_ANGLE_OFFSET;
use ::calibrate::{ClearJoint, Observation, Parameter, Problem, Run, alignment};
use calibrate::CrankMotion;
use input::bundle::Bundle;
use input::bundle_channel::Meaning;
use input::calibration;
use input::unit::Dimension;
use input::{MachineFile, paths};
use serde_json::Value;
use sha2::{Digest, Sha256};
use signal::crank_angle::CrankAngle;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Of so many runs one is held out.
const HELD_OUT: usize = 4;
/// Most evaluations of the model.
const EVALUATIONS: u32 = 5000;
/// Change of a run's zero of the crank angle that is worth another fit, rad: a tenth of the noise of
/// usual lines.
const ALIGNED: f64 = 1e-5;

/// Relative difference from which a measured speed takes the place of the stated one: an encoder
/// tells it better than a recording's other errors.
const SPEED: f64 = 2e-5;

/// What `calibration.json` holds beyond the fit: one without it is made anew.
const CONTENT: &str = "converters";

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
    /// For each run whether an encoder gave the crank angle.
    pub encoded: Vec<bool>,
    /// The columns that the machine has.
    columns: Vec<String>,
}

/// The task that the settings state.
///
/// # Errors
/// Settings, a machine or runs that cannot be used or contradict each other.
pub fn task(settings: &Settings) -> Result<Task, Failure> {
    let asked = settings.calibration;
    let bundles = bundles(settings)?;
    let machine = asked.machine.as_ref().map(|path| settings.base.join(path));
    let mut tree = match settings.machine {
        Some(tree) => tree.clone(),
        None => bundle::machine(&bundles[0].bundle, machine.as_deref())?,
    };
    let mut runs = Vec::new();
    let mut zeroed = Vec::new();
    let mut encoded = Vec::new();
    for listed in &bundles {
        for (run, meanings) in listed.runs(settings, &tree)? {
            let any = |wanted: fn(&Meaning) -> bool| meanings.iter().any(wanted);
            zeroed.push(any(|m| {
                matches!(m, Meaning::CrankAngle(_) | Meaning::Tacho { at: Some(_) })
            }));
            encoded.push(any(|m| matches!(m, Meaning::CrankAngle(_))));
            runs.push(run);
        }
    }
    let free = tree["crank"]["drive"]["free"].is_object();
    for run in &mut runs {
        turn(run, free)?;
    }
    let Some(first) = runs.first() else {
        return Err(Failure::input("every run is left out"));
    };
    // The machine stands at the conditions of the first run where it has none of its own.
    for (path, value) in &first.settings {
        paths::set(&mut tree, path, value.clone())?;
    }
    let fit_settings = fit_settings(settings, &tree, &runs)?;
    let exponents = relation::set(settings, &mut tree, &runs, &fit_settings.held_out)?;
    let source = machine.unwrap_or_else(|| bundles[0].bundle.folder.join(input::bundle::FILE));
    let resolved = MachineFile::from_tree(&tree).and_then(|file| file.resolve());
    let resolved =
        resolved.map_err(|error| Failure::input(format!("{}: {error}", source.display())))?;
    let mut parameters = parameters(settings, &tree, &runs)?;
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
            meter: calibrate::meter::Meter::default(),
        },
        runs,
        zeroed,
        encoded,
        columns: columns(&resolved),
    };
    task.observe()?;
    Ok(task)
}

impl Task {
    /// Looks at all runs, and holds them against the nominal machine.
    fn observe(&mut self) -> Result<(), Failure> {
        let seen = self.runs.iter().map(|run| observe(run, &self.columns));
        self.problem.runs = seen.collect::<Result<_, _>>()?;
        let nominal = vec![0.0; self.problem.parameters.len()];
        self.align(&nominal)?;
        let start = self.start_at_zero()?;
        contradiction::check(&self.problem, start.as_ref().unwrap_or(&nominal))?;
        self.settings.start = start;
        Ok(())
    }

    /// Where the search starts if the recorded zero of the crank angle is nowhere near top dead centre; the bounds of
    /// the offset are opened that far.
    fn start_at_zero(&mut self) -> Result<Option<Vec<f64>>, Failure> {
        let parameters = self.problem.parameters.iter();
        let mut offsets = parameters
            .clone()
            .enumerate()
            .filter(|(_, p)| p.is_crank_angle_offset());
        let (Some((i, _)), None) = (offsets.next(), offsets.next()) else {
            return Ok(None);
        };
        let Some(offset) =
            ::calibrate::zero::crank_angle_offset(&self.problem).map_err(Failure::input)?
        else {
            return Ok(None);
        };
        let parameter = &mut self.problem.parameters[i];
        if parameter.run.is_some() || !parameter.open_for_offset(offset) {
            return Ok(None);
        }
        let mut start = vec![0.0; self.problem.parameters.len()];
        start[i] = self.problem.parameters[i].coordinate(offset);
        Ok(Some(start))
    }

    /// Sets the zero of the crank angle of every run where it was not recorded to what the machine
    /// with the parameters at `x` shows; whether that has moved one.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn align(&mut self, x: &[f64]) -> Result<bool, Failure> {
        let mut moved = false;
        for i in (0..self.runs.len())
            .filter(|i| !self.zeroed[*i])
            .collect::<Vec<_>>()
        {
            let observed = &self.problem.runs[i];
            let predicted = predict(&self.problem, observed, x).map_err(Failure::input)?;
            let shift = alignment::phase(observed, &predicted);
            if shift.abs() < ALIGNED {
                continue;
            }
            moved = true;
            for angle in self.runs[i].crank_angle.iter_mut().flatten() {
                *angle = (*angle + shift).rem_euclid(TAU);
            }
            self.problem.runs[i] = observe(&self.runs[i], &self.columns)?;
        }
        Ok(moved)
    }

    /// What tells this calibration from others: the recordings, the machine, what is fitted and how,
    /// and the version of this program. SHA-256 in hexadecimal.
    pub fn fingerprint(&self) -> String {
        let mut hash = Sha256::new();
        let mut add = |text: &str| {
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text);
        };
        add(env!("CARGO_PKG_VERSION"));
        add(CONTENT);
        add(&self.problem.tree.to_string());
        let settings = &self.settings;
        add(&format!("{:?} {:?}", settings.optimiser, settings.seed));
        add(&format!("{:?}", settings.held_out));
        for parameter in &self.problem.parameters {
            add(&format!("{parameter:?}"));
        }
        for run in &self.runs {
            add(&format!(
                "{} {:?} {} {} {}",
                run.id, run.settings, run.speed_rpm, run.sample_rate, run.is_timed
            ));
            for channel in &run.channels {
                add(&channel.column);
            }
        }
        for run in &self.runs {
            let series = run.channels.iter().map(|channel| &channel.samples);
            for samples in run.crank_angle.iter().chain(series) {
                hash.update((samples.len() as u64).to_le_bytes());
                for x in samples {
                    hash.update(x.to_bits().to_le_bytes());
                }
            }
        }
        format!("{:x}", hash.finalize())
    }
}

/// Gives a run the speed at which it turns, and a crank angle of that speed where it has none.
fn turn(run: &mut Run, free: bool) -> Result<(), Failure> {
    let measured = match &run.crank_angle {
        Some(angle) => {
            let angle = CrankAngle::from_encoder(angle);
            let angle = angle.map_err(|error| bundle::unusable(&run.id, &error.to_string()))?;
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

fn observe(run: &Run, columns: &[String]) -> Result<Observation, Failure> {
    Observation::of(run, columns).map_err(|error| bundle::unusable(&run.id, &error.to_string()))
}

/// A bundle, and what its runs are called in front.
struct Listed {
    bundle: Bundle,
    prefix: String,
}

fn bundles(settings: &Settings) -> Result<Vec<Listed>, Failure> {
    let paths = settings.calibration.bundles();
    let mut listed: Vec<Listed> = Vec::new();
    for path in paths {
        let bundle = settings.outside.read(&settings.base.join(path))?;
        let name = path
            .file_name()
            .unwrap_or(path.as_os_str())
            .to_string_lossy();
        let prefix = match paths.len() {
            1 => String::new(),
            _ => format!("{name}/"),
        };
        let bundle_file = |b: &Bundle| b.folder.join(input::bundle::FILE).display().to_string();
        if listed.iter().any(|other| other.prefix == prefix) {
            return Err(Failure::input(format!(
                "two bundles are called {name}: give their folders different names"
            )));
        }
        if let Some(first) = listed.first()
            && !settings.has_machine_file()
            && first.bundle.machine != bundle.machine
        {
            return Err(Failure::input(format!(
                "{} and {} have different machine sections: give the machine file that holds for both",
                bundle_file(&first.bundle),
                bundle_file(&bundle)
            )));
        }
        listed.push(Listed { bundle, prefix });
    }
    Ok(listed)
}

impl Listed {
    /// The runs, each with what its channels are.
    fn runs(&self, settings: &Settings, tree: &Value) -> Result<Vec<(Run, Vec<Meaning>)>, Failure> {
        let known: Vec<&str> = self.bundle.runs.iter().map(|run| run.id.as_str()).collect();
        let named = settings.calibration.leave_out.iter();
        let own = named.filter_map(|id| id.strip_prefix(&self.prefix));
        let own: Vec<String> = own.map(str::to_owned).collect();
        if let Some(unknown) = own.iter().find(|id| !known.contains(&id.as_str())) {
            let error = input::Error::unknown_name("leave_out", unknown, &known);
            return Err((settings.locate)(error).into());
        }
        let throws = bundle::throws(tree);
        let kept = (0..known.len()).filter(|i| !own.iter().any(|id| id == known[*i]));
        let runs = bundle::runs(&self.bundle, tree, &own)?;
        let runs = runs.into_iter().zip(kept).map(|(mut run, i)| {
            run.id = format!("{}{}", self.prefix, run.id);
            Ok((run, bundle::meanings(&self.bundle, i, &throws)?))
        });
        runs.collect()
    }
}

/// What is fitted: the paths of the settings, else the contact of the joints that are clear.
fn parameters(settings: &Settings, tree: &Value, runs: &[Run]) -> Result<Vec<Parameter>, Failure> {
    let asked = &settings.calibration.parameters.0;
    let refuse = |path: &str, reason: String| {
        let key = format!("parameters.{path}");
        Failure::from((settings.locate)(input::Error::new(
            key,
            input::Problem::Other(reason),
        )))
    };
    let of = |path: &str, bounds: Option<[f64; 2]>| {
        Parameter::named(tree, runs, path, bounds).map_err(|e| refuse(path, e.to_string()))
    };
    if asked.is_empty() {
        let defaults = defaults(tree, runs)?;
        return defaults.iter().map(|path| of(path, None)).collect();
    }
    let mut parameters: Vec<Parameter> = Vec::new();
    for (path, bounds) in asked {
        let parameter = of(path, bounds.map(|bounds| bounds.map(|b| b.si)))?;
        if let Some([low, _]) = bounds
            && low.dimension != parameter.dimension
        {
            let unit = parameter
                .dimension
                .as_ref()
                .map_or("none".to_owned(), Dimension::to_string);
            let reason = format!("the bounds have another unit than its value ({unit})");
            return Err(refuse(path, reason));
        }
        if parameters.iter().any(|p| p.path == *path) {
            return Err(refuse(path, "it is named twice".into()));
        }
        parameters.push(parameter);
    }
    // The zero of the encoder is the recordings' and not the machine's: whatever is asked of the machine, an
    // encoder's last digit matters. A bound of its own holds it where it is known.
    let has_offset = parameters.iter().any(Parameter::is_crank_angle_offset);
    if !has_offset && !are_pressures_alone(runs) {
        parameters.push(of(CRANK_ANGLE_OFFSET, None)?);
    }
    Ok(parameters)
}

fn are_pressures_alone(runs: &[Run]) -> bool {
    let mut columns = runs.iter().flat_map(|run| &run.channels).map(|c| &c.column);
    columns.all(|column| column.contains("cylinder_pressure"))
}

/// What is fitted where nothing is asked for: the contact of the joints that are clear, and the zero
/// of the crank angle, of which an encoder's last digit already matters; the gas where pressures are
/// all that was recorded.
/// A joint of which no run speaks has the clearance that the machine file states.
fn defaults(tree: &Value, runs: &[Run]) -> Result<Vec<String>, Failure> {
    if are_pressures_alone(runs) {
        return Ok(gas_defaults(runs));
    }
    let clear = |(path, value): &&(String, Value)| path.ends_with(".clearance") && value != "ideal";
    let settings = runs.iter().flat_map(|run| &run.settings).filter(clear);
    let mut joints: Vec<String> = settings
        .map(|(path, _)| path.trim_end_matches(".clearance").to_owned())
        .collect();
    let of_runs = runs.iter().map(|run| &run.settings[..]);
    let of_machine = ClearJoint::of(tree, of_runs).map_err(Failure::input)?;
    joints.extend(of_machine.into_iter().map(|joint| joint.path));
    joints.sort_unstable();
    joints.dedup();
    let keys = [
        "contact.stiffness",
        "contact.damping",
        "friction.coefficient",
    ];
    let of_joint = |joint: &String| keys.map(|key| format!("{joint}.{key}"));
    let contacts = joints.iter().flat_map(of_joint);
    Ok(contacts.chain([CRANK_ANGLE_OFFSET.to_owned()]).collect())
}

/// The exponent and the clearance of every chamber with a pressure, and the pressures of the lines
/// in each run.
fn gas_defaults(runs: &[Run]) -> Vec<String> {
    let mut paths = BTreeSet::new();
    for run in runs {
        for channel in &run.channels {
            let (throw, name) = match channel.column.split_once('.') {
                Some((throw, name)) => (format!("throws.{throw}."), name),
                None => (String::new(), channel.column.as_str()),
            };
            let clearance = match name.contains("crank_end") {
                true => "crank_end.clearance",
                false => "head_clearance",
            };
            for value in ["exponent", clearance] {
                paths.insert(format!("{throw}cylinder.{value}"));
            }
            for line in ["suction", "discharge"] {
                paths.insert(format!("runs.{}.{throw}cylinder.{line}", run.id));
            }
        }
    }
    paths.into_iter().collect()
}

fn fit_settings(settings: &Settings, tree: &Value, runs: &[Run]) -> Result<FitSettings, Failure> {
    let asked = settings.calibration;
    let ids: Vec<&str> = runs.iter().map(|run| run.id.as_str()).collect();
    let held_out = match &asked.hold_out {
        None => held_out(tree, runs)?,
        Some(named) => {
            if let Some(unknown) = named.iter().find(|id| !ids.contains(&id.as_str())) {
                let error = input::Error::unknown_name("hold_out", unknown, &ids);
                return Err((settings.locate)(error).into());
            }
            if ids.iter().all(|id| named.iter().any(|held| held == id)) {
                let expected = "at least one run to fit to";
                let error = input::Error::found("hold_out", "every run", expected);
                return Err((settings.locate)(error).into());
            }
            named.clone()
        }
    };
    Ok(FitSettings {
        optimiser: optimiser(asked.optimiser),
        seed: asked.seed.map_or(0, |seed| u64::from(seed.get())),
        evaluations: u64::from(asked.evaluations.map_or(EVALUATIONS, |n| n.get())),
        held_out,
        start: None,
    })
}

/// Of every four runs the last whose clearances a run has that is fitted: what the parameters are at
/// other clearances is another question.
fn held_out(tree: &Value, runs: &[Run]) -> Result<Vec<String>, Failure> {
    let joints = ClearJoint::of(tree, runs.iter().map(|run| &run.settings[..]));
    let joints = joints.map_err(Failure::input)?;
    let states = runs.iter().map(|r| clearances(tree, &joints, &r.settings));
    let states: Vec<_> = states.collect::<Result<_, _>>().map_err(Failure::input)?;
    let mut held_out: Vec<usize> = Vec::new();
    for last in (HELD_OUT - 1..runs.len()).step_by(HELD_OUT) {
        let shared = |i: &usize| {
            let mut others = (0..runs.len()).filter(|j| j != i && !held_out.contains(j));
            others.any(|j| states[j] == states[*i])
        };
        let group = last + 1 - HELD_OUT..=last;
        held_out.extend(group.rev().find(shared));
    }
    Ok(held_out.into_iter().map(|i| runs[i].id.clone()).collect())
}

fn optimiser(asked: calibration::Optimiser) -> Optimiser {
    match asked {
        calibration::Optimiser::Default => Optimiser::Default,
        calibration::Optimiser::CmaEs => Optimiser::CmaEs,
        calibration::Optimiser::LevenbergMarquardt => Optimiser::LevenbergMarquardt,
        calibration::Optimiser::Genetic(asked) => {
            let asked = asked.unwrap_or_default();
            let usual = Genetic::default();
            Optimiser::Genetic(Genetic {
                population: asked
                    .population
                    .map_or(usual.population, |n| n.get() as usize),
                crossover: asked.crossover.map_or(usual.crossover, |x| x.get()),
                mutation: asked.mutation.map_or(usual.mutation, |x| x.get()),
            })
        }
    }
}
