//! Recordings that are made here.
//!
//! Noise is 2 to 3 % of an acceleration's RMS, 0.5 % of a pressure's, 30 % of its power 1/f, then 16 bits. The
//! encoder counts down to whole steps, so that the crank angle has an offset of half a step.

use calibrate::{Channel, Run};
use input::MachineFile;
use rand::RngExt;
use scalar::random::{Purpose, stream};
use serde_json::Value;
use simulate::sensor::Quantity;
use simulate::{Measured, Sensor, Settings, Transient};
use std::error::Error;

/// Accuracy of the recordings: a hundred times that of the fit.
const TOLERANCE: f64 = 1e-9;
const SAMPLE_RATE: f64 = 20_000.0;
const REVOLUTIONS: u32 = 30;

/// A recording without noise.
pub struct Clean {
    pub id: String,
    pub settings: Vec<(String, Value)>,
    pub speed_rpm: f64,
    pub columns: Vec<String>,
    pub series: Vec<Vec<f64>>,
}

/// The run of a machine without noise, in the columns of what is `measured` and the crank angle.
pub fn clean(
    id: &str,
    settings: &[(String, Value)],
    tree: &Value,
    measured: &[Measured],
) -> Result<Clean, Box<dyn Error>> {
    let machine = MachineFile::from_tree(tree)?.resolve()?;
    let throws = machine.machine.throws.iter();
    let names: Vec<&str> = throws.map(|t| t.name.as_str()).collect();
    let mut measured = measured.to_vec();
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

/// The same with noise.
pub fn noisy(clean: &Clean, seed: u64, index: u64) -> Result<Run, Box<dyn Error>> {
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
