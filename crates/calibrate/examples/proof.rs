//! Measures what a calibration reaches on recordings whose truth is known: made here, from the
//! machine and the runs of a bundle, with other contact parameters and noise.
//!
//! ```text
//! proof coverage BUNDLE MACHINES COPIES SEED   truths drawn, copies noised, bounds counted
//! proof compare BUNDLE SEED MOST               evaluations and time of each optimiser, MOST at most
//! ```
//!
//! Contact parameters are drawn between 0.6 and 1.4 times their nominal values. Noise is 2 to 3 %
//! of the acceleration's RMS, 0.5 % of the pressure's, 30 % of its power 1/f, then 16 bits. The
//! encoder counts down to whole steps, so that the crank angle has an offset of half a step.

#![allow(clippy::print_stdout)]

use calibrate::CrankMotion;
use calibrate::fit::{FitSettings, Optimiser};
use calibrate::optimiser::Genetic;
use calibrate::run_condition::CRANK_ANGLE_OFFSET;
use calibrate::{Channel, Fit, Observation, Parameter, Problem, Run, calibrate};
use input::bundle::Bundle;
use input::{MachineFile, paths};
use rand::RngExt;
use scalar::random::{Purpose, stream};
use serde_json::Value;
use simulate::{Chain, ChamberEnd, Measured, Sensor, Settings, Transient};
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// Accuracy of the recordings: a hundred times that of the fit.
const TOLERANCE: f64 = 1e-9;
const SAMPLE_RATE: f64 = 20_000.0;
const REVOLUTIONS: u32 = 30;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["coverage", bundle, machines, copies, seed] => coverage(
            &Bench::open(Path::new(bundle))?,
            machines.parse()?,
            copies.parse()?,
            seed.parse()?,
        ),
        ["truth", bundle, seed] => truth(&Bench::open(Path::new(bundle))?, seed.parse()?),
        ["compare", bundle, seed, most] => compare(
            &Bench::open(Path::new(bundle))?,
            seed.parse()?,
            most.parse()?,
        ),
        _ => Err(
            "usage: proof coverage BUNDLE MACHINES COPIES SEED | proof compare BUNDLE SEED MOST"
                .into(),
        ),
    }
}

/// A machine with its runs, and what is fitted of it.
struct Bench {
    tree: Value,
    runs: Vec<(String, Vec<(String, Value)>)>,
    parameters: Vec<Parameter>,
}

/// A recording without noise.
struct Clean {
    id: String,
    settings: Vec<(String, Value)>,
    speed_rpm: f64,
    columns: Vec<String>,
    series: Vec<Vec<f64>>,
}

impl Bench {
    fn open(path: &Path) -> Result<Self, Box<dyn Error>> {
        let bundle = Bundle::read(path)?;
        let tree = input::from_bundle(&bundle.machine)?;
        let runs = bundle
            .runs
            .iter()
            .map(|run| Ok((run.id.clone(), input::run_settings(&run.section, &tree)?)))
            .collect::<Result<Vec<_>, input::Error>>()?;
        let mut joints: Vec<String> = runs
            .iter()
            .flat_map(|(_, settings)| settings)
            .filter(|(path, value)| path.ends_with(".clearance") && value != "ideal")
            .map(|(path, _)| path.trim_end_matches(".clearance").to_owned())
            .collect();
        joints.sort_unstable();
        joints.dedup();
        let mut whole = tree.clone();
        for (path, value) in &runs[0].1 {
            paths::set(&mut whole, path, value.clone())?;
        }
        let keys = [
            "contact.stiffness",
            "contact.damping",
            "friction.coefficient",
        ];
        let contacts = joints
            .iter()
            .flat_map(|joint| keys.map(|key| format!("{joint}.{key}")))
            .chain([CRANK_ANGLE_OFFSET.to_owned()]);
        let parameters = contacts
            .map(|path| Parameter::named(&whole, &[], &path, None))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            tree: whole,
            runs,
            parameters,
        })
    }

    /// True values between 0.6 and 1.4 times the nominal ones.
    fn truth(&self, seed: u64, machine: u64) -> Vec<f64> {
        let mut random = stream(seed, machine, Purpose::Variation);
        let parameters = self.parameters.iter();
        parameters
            .map(|p| p.nominal * random.random_range(0.6..1.4))
            .collect()
    }

    fn simulated(&self, truth: &[f64]) -> Result<Vec<Clean>, Box<dyn Error>> {
        let mut tree = self.tree.clone();
        for (parameter, value) in self.parameters.iter().zip(truth) {
            parameter.write(&mut tree, *value)?;
        }
        self.runs
            .iter()
            .map(|(id, settings)| {
                let mut tree = tree.clone();
                for (path, value) in settings {
                    paths::set(&mut tree, path, value.clone())?;
                }
                clean(id, settings, &tree)
            })
            .collect()
    }

    fn problem(&self, clean: &[Clean], seed: u64, copy: u64) -> Result<Problem, Box<dyn Error>> {
        let runs = clean.iter().enumerate().map(|(i, clean)| {
            let run = noisy(clean, seed, copy * 1000 + i as u64)?;
            Ok(Observation::of(&run, &clean.columns)?)
        });
        Ok(Problem {
            tree: self.tree.clone(),
            parameters: self.parameters.clone(),
            runs: runs.collect::<Result<_, Box<dyn Error>>>()?,
            crank: CrankMotion::Driven,
        })
    }
}

fn clean(id: &str, settings: &[(String, Value)], tree: &Value) -> Result<Clean, Box<dyn Error>> {
    let machine = MachineFile::from_tree(tree)?.resolve()?;
    let throws = machine.machine.throws.iter();
    let names: Vec<&str> = throws.map(|t| t.name.as_str()).collect();
    let mut measured: Vec<Measured> = (0..names.len())
        .flat_map(|throw| {
            let end = ChamberEnd::Head;
            [
                Measured::CrossheadAcceleration { throw },
                Measured::CylinderPressure { throw, end },
            ]
        })
        .collect();
    measured.push(Measured::CrankAngle);
    let columns = measured.iter().map(|m| m.column(&names)).collect();
    let sensors: Vec<Sensor> = measured
        .into_iter()
        .map(|measured| Sensor {
            measured,
            chain: Chain::default(),
        })
        .collect();
    let settings_of_run = Settings {
        transient: Transient::Revolutions(40),
        revolutions: REVOLUTIONS,
        sample_rate: SAMPLE_RATE,
        tolerance: TOLERANCE,
    };
    let record = simulate::simulate(&machine.machine, &sensors, &settings_of_run, false)?;
    Ok(Clean {
        id: id.to_owned(),
        settings: settings.to_vec(),
        speed_rpm: machine.speed.abs() * 30.0 / std::f64::consts::PI,
        columns,
        series: record.series,
    })
}

fn noisy(clean: &Clean, seed: u64, index: u64) -> Result<Run, Box<dyn Error>> {
    let mut random = stream(seed, index, Purpose::Noise);
    let level = random.random_range(0.02..0.03);
    let mut channels = Vec::new();
    let (angle, series) = clean.series.split_last().ok_or("no series")?;
    for (column, x) in clean.columns.iter().zip(series) {
        let share = if column.contains("acceleration") {
            level
        } else {
            0.005
        };
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        let rms = (x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / x.len() as f64).sqrt();
        let mut normal = || normal(&mut random);
        let pink = signal::noise::pink_noise(x.len(), share * rms * 0.3_f64.sqrt(), &mut normal)?;
        let white = share * rms * 0.7_f64.sqrt();
        let count = 2.4 * x.iter().fold(0.0_f64, |m, x| m.max(x.abs())) / 65_536.0;
        let samples = x.iter().zip(&pink);
        let samples =
            samples.map(|(x, pink)| ((x + pink + white * normal()) / count).round() * count);
        channels.push(Channel {
            column: column.clone(),
            samples: samples.collect(),
        });
    }
    let count = std::f64::consts::TAU / 65_536.0;
    Ok(Run {
        id: clean.id.clone(),
        settings: clean.settings.clone(),
        speed_rpm: clean.speed_rpm,
        sample_rate: SAMPLE_RATE,
        crank_angle: Some(angle.iter().map(|x| (x / count).floor() * count).collect()),
        channels,
    })
}

/// A standard normal number (Box and Muller 1958).
fn normal(random: &mut scalar::random::Stream) -> f64 {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
}

fn settings(optimiser: Optimiser, seed: u64, problem: &Problem) -> FitSettings {
    FitSettings {
        optimiser,
        seed,
        evaluations: 20_000,
        held_out: problem
            .runs
            .iter()
            .skip(3)
            .step_by(4)
            .map(|r| r.id.clone())
            .collect(),
        start: None,
    }
}

fn coverage(bench: &Bench, machines: u64, copies: u64, seed: u64) -> Result<(), Box<dyn Error>> {
    let (mut inside, mut told, mut all) = (0, 0, 0);
    for machine in 0..machines {
        let truth = bench.truth(seed, machine);
        let clean = bench.simulated(&truth)?;
        for copy in 0..copies {
            let problem = bench.problem(&clean, seed, machine * copies + copy)?;
            let start = Instant::now();
            let fit = calibrate(
                &problem,
                &settings(Optimiser::Default, seed, &problem),
                |_| ControlFlow::Continue(()),
            )?;
            let (mut wrong, mut untold) = (Vec::new(), Vec::new());
            for (estimate, truth) in fit.estimates.iter().zip(&truth) {
                if estimate.parameter.path == CRANK_ANGLE_OFFSET {
                    continue;
                }
                all += 1;
                match estimate.interval {
                    Some([low, high]) => {
                        told += 1;
                        if (low..=high).contains(truth) {
                            inside += 1;
                        } else {
                            let deviation = (estimate.value - truth) / (0.5 * (high - low) / 1.96);
                            wrong.push(format!("{} {deviation:+.1} s", estimate.parameter.path));
                        }
                    }
                    None => untold.push(estimate.parameter.path.clone()),
                }
            }
            println!(
                "machine {machine} copy {copy}: {} of {} inside, misfit {:.3} fitted, {:.3} held out, {} evaluations, {:.1} s; outside: {}; not told: {}",
                told_inside(&fit, &truth),
                fit.estimates.len() - untold.len(),
                fit.misfit(false, |r| r.calibrated).unwrap_or(f64::NAN),
                fit.misfit(true, |r| r.calibrated).unwrap_or(f64::NAN),
                fit.evaluations,
                start.elapsed().as_secs_f64(),
                wrong.join(", "),
                untold.join(", "),
            );
        }
    }
    println!(
        "{inside} of {told} bounds hold the truth; {} of {all} not told",
        all - told
    );
    Ok(())
}

fn told_inside(fit: &Fit, truth: &[f64]) -> usize {
    let pairs = fit.estimates.iter().zip(truth);
    pairs
        .filter(|(e, truth)| {
            e.interval
                .is_some_and(|[low, high]| (low..=high).contains(truth))
        })
        .count()
}

/// The misfit of each run and channel at the truth.
fn truth(bench: &Bench, seed: u64) -> Result<(), Box<dyn Error>> {
    let truth = bench.truth(seed, 0);
    let problem = bench.problem(&bench.simulated(&truth)?, seed, 0)?;
    let parameters = problem.parameters.iter().zip(&truth);
    let x: Vec<f64> = parameters.map(|(p, value)| p.coordinate(*value)).collect();
    for run in &problem.runs {
        for channel in &run.channels {
            let mut alone = problem.with_runs(|other| other.id == run.id);
            alone.runs[0]
                .channels
                .retain(|c| c.column == channel.column);
            let residuals = calibrate::likelihood::Likelihood::new(&alone)
                .by_run(&x)?
                .concat();
            let parts: Vec<String> = residuals
                .chunks(residuals.len().div_ceil(4))
                .map(|part| format!("{:.2}", calibrate::likelihood::misfit(part)))
                .collect();
            println!(
                "{} {}: {} orders, {}",
                run.id,
                channel.column,
                channel.orders.len(),
                parts.join(" ")
            );
            for k in [1, 2, 3, 5, 8, 13] {
                println!(
                    "  {k}: {:.2} {:.2} sd {:.3e}",
                    residuals[2 * k],
                    residuals[2 * k + 1],
                    channel.lines.variance[k].sqrt()
                );
            }
        }
    }
    Ok(())
}

/// Bounds of every optimiser's search, over the nominal values: a user of a genetic algorithm would
/// not search further.
const SEARCHED: [f64; 2] = [0.5, 2.0];

/// Every optimiser on the same recordings and within the same bounds, until its misfit is within a
/// tenth of the best.
fn compare(bench: &Bench, seed: u64, most: u64) -> Result<(), Box<dyn Error>> {
    let truth = bench.truth(seed, 0);
    let mut problem = bench.problem(&bench.simulated(&truth)?, seed, 0)?;
    for parameter in &mut problem.parameters {
        if parameter.path != CRANK_ANGLE_OFFSET {
            parameter.bounds = SEARCHED.map(|share| share * parameter.nominal);
        }
    }
    let mut goal = 0.0;
    for (optimiser, limit) in [
        (Optimiser::Default, 0.0),
        (Optimiser::LevenbergMarquardt, 1.0),
        (Optimiser::CmaEs, 1.0),
        (Optimiser::Genetic(Genetic::default()), 1.0),
    ] {
        let start = Instant::now();
        let (mut evaluations, mut best, mut told) = (0, f64::INFINITY, f64::INFINITY);
        calibrate(&problem, &settings(optimiser, seed, &problem), |progress| {
            (evaluations, best) = (progress.evaluations, progress.misfit());
            if best < told / 1.3 {
                told = best;
                let seconds = start.elapsed().as_secs_f64();
                println!("  misfit {best:.3} after {evaluations} evaluations, {seconds:.1} s");
            }
            if best <= 1.1 * goal * limit || evaluations >= most {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })?;
        if goal == 0.0 {
            goal = best;
        }
        println!(
            "{}: misfit {best:.3} after {evaluations} evaluations, {:.1} s",
            optimiser.name(),
            start.elapsed().as_secs_f64(),
        );
    }
    Ok(())
}
