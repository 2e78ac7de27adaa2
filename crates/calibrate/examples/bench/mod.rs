//! Recordings whose truth is known: made from the machine and the runs of a bundle, with other contact
//! parameters and noise.
//!
//! Contact parameters are drawn between 0.6 and 1.4 times their nominal values. Noise is 2 to 3 %
//! of the acceleration's RMS, 0.5 % of the pressure's, 30 % of its power 1/f, then 16 bits. The
//! encoder counts down to whole steps, so that the crank angle has an offset of half a step.

use calibrate::run_condition::CRANK_ANGLE_OFFSET;
use calibrate::{Channel, CrankMotion, Observation, Parameter, Problem, Run};
use input::bundle::Bundle;
use input::{MachineFile, paths};
use rand::RngExt;
use scalar::random::{Purpose, stream};
use serde_json::Value;
use simulate::sensor::Quantity;
use simulate::{ChamberEnd, Measured, Sensor, Settings, Transient};
use std::error::Error;
use std::path::Path;

/// Accuracy of the recordings: a hundred times that of the fit.
const TOLERANCE: f64 = 1e-9;
const SAMPLE_RATE: f64 = 20_000.0;
const REVOLUTIONS: u32 = 30;

/// A machine with its runs, and what is fitted of it.
pub struct Bench {
    pub tree: Value,
    pub runs: Vec<(String, Vec<(String, Value)>)>,
    pub parameters: Vec<Parameter>,
}

/// A recording without noise.
pub struct Clean {
    id: String,
    settings: Vec<(String, Value)>,
    speed_rpm: f64,
    columns: Vec<String>,
    series: Vec<Vec<f64>>,
}

impl Bench {
    /// The machine and the runs of a bundle.
    pub fn open(path: &Path) -> Result<Self, Box<dyn Error>> {
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
    pub fn truth(&self, seed: u64, machine: u64) -> Vec<f64> {
        let mut random = stream(seed, machine, Purpose::Variation);
        let parameters = self.parameters.iter();
        parameters
            .map(|p| p.nominal * random.random_range(0.6..1.4))
            .collect()
    }

    /// The runs without noise, of a machine with the contact parameters `truth`.
    pub fn simulated(&self, truth: &[f64]) -> Result<Vec<Clean>, Box<dyn Error>> {
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

    /// The runs with noise, and the machine with its nominal parameters.
    pub fn problem(
        &self,
        clean: &[Clean],
        seed: u64,
        copy: u64,
    ) -> Result<Problem, Box<dyn Error>> {
        let runs = clean.iter().enumerate().map(|(i, clean)| {
            let run = noisy(clean, seed, copy * 1000 + i as u64)?;
            Ok(Observation::from_run(&run, &clean.columns)?)
        });
        Ok(Problem {
            tree: self.tree.clone(),
            parameters: self.parameters.clone(),
            runs: runs.collect::<Result<_, Box<dyn Error>>>()?,
            crank: CrankMotion::Driven,
            meter: calibrate::meter::Meter::default(),
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
        .map(|measured| machine.perfect_sensor(measured))
        .collect();
    let settings_of_run = Settings {
        transient: Transient::Revolutions(40),
        revolutions: REVOLUTIONS,
        sample_rate: SAMPLE_RATE,
        inner_rate: 80_000.0,
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
        let share = if Quantity::of_column(column).is_acceleration() {
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
        is_timed: true,
        crank_angle: Some(angle.iter().map(|x| (x / count).floor() * count).collect()),
        channels,
    })
}

/// A standard normal number (Box and Muller 1958).
fn normal(random: &mut scalar::random::Stream) -> f64 {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
}
