//! Recordings that are made here: a bundle on the disk, as another program would leave it.

use crate::error::Error;
use crate::machine::{Machine, RunConditions};
use crate::outside::Outside;
use crate::settings::HiddenEffects;
use input::MachineFile;
use input::bundle;
use rayon::prelude::*;
use recordings::formats::parquet;
use recordings::formats::parquet::ROWS_PER_GROUP;
use recordings::{Column, Data, Kind, Schema, Table, WholeFile};
use scalar::random::{Purpose, stream};
use serde::Serialize;
use serde_json::{Map, Value};
use signal::channel::Channel;
use signal::crank_angle::CrankAngle;
use simulate::{
    ChamberEnd, Measured, Noise, NoiseLevel, Range, Record, Sensor, Settings, Transient,
};
use std::f64::consts::TAU;
use std::path::Path;

/// Accuracy of the recordings: a hundred times that of the fit.
const RECORDED_TOLERANCE: f64 = 1e-9;
/// Revolutions before a recording.
const TRANSIENT: u32 = 60;
const REVOLUTIONS: u32 = 30;
const SAMPLE_RATE: f64 = 20_000.0;
/// Share of the noise's power that is 1/f.
const PINK: f64 = 0.3;
/// Noise of the pressures over that of the accelerations.
const PRESSURE_NOISE: f64 = 0.25;
/// Range of a recorder over the greatest sample; the first value for a channel that is 0.
const RANGE: [f64; 2] = [1.0, 1.2];
const BITS: u32 = 16;
/// Steps of the encoder in a revolution; it counts down to whole ones.
const STEPS: f64 = 65_536.0;

/// How recordings are made.
#[derive(Clone, Copy, Debug)]
pub struct Recorder {
    settings: Settings,
    seed: u64,
}

/// A run without noise.
pub struct Clean {
    sensors: Vec<Sensor>,
    record: Record,
}

impl Recorder {
    /// That of a file.
    pub fn new(settings: &HiddenEffects) -> Self {
        let revolutions = settings.revolutions.map_or(REVOLUTIONS, |n| n.get());
        let sample_rate = settings.sample_rate.as_ref().map(|rate| rate.si());
        Self {
            settings: Settings {
                transient: Transient::Revolutions(TRANSIENT),
                revolutions,
                sample_rate: sample_rate.unwrap_or(SAMPLE_RATE),
                inner_rate: Settings::default().inner_rate,
                tolerance: RECORDED_TOLERANCE,
            },
            seed: u64::from(settings.seed.map_or(0, |seed| seed.get())),
        }
    }

    /// The run of `machine`, whose machine file is `tree`, at these conditions.
    ///
    /// # Errors
    /// In words, why it cannot be.
    pub fn run(
        &self,
        machine: &Machine,
        tree: &Value,
        run: &RunConditions,
    ) -> Result<Clean, String> {
        let tree = machine.at(tree, run).map_err(|e| e.to_string())?;
        let resolved = MachineFile::from_tree(&tree).and_then(|file| file.resolve());
        let resolved = resolved.map_err(|e| e.to_string())?;
        let throws = 0..resolved.machine.throws.len();
        let end = ChamberEnd::Head;
        let pressure = |throw| Measured::CylinderPressure { throw, end };
        let measured = std::iter::once(Measured::CrankAngle)
            .chain(
                throws
                    .clone()
                    .map(|throw| Measured::CrossheadAcceleration { throw }),
            )
            .chain(throws.filter(|_| machine.pressure).map(pressure));
        let mut sensors: Vec<Sensor> = measured.map(|m| resolved.perfect_sensor(m)).collect();
        // Rounded to the nearest step it is then rounded down.
        sensors[0].chain.angle_offset -= 0.5 * TAU / STEPS;
        let record = simulate::simulate(&resolved.machine, &sensors, &self.settings, false);
        Ok(Clean {
            record: record.map_err(|e| e.to_string())?,
            sensors,
        })
    }

    /// Changes a run to what no model has.
    pub fn change(&self, run: &mut Clean, outside: Outside) {
        outside.change(&mut run.record, &run.sensors);
    }

    /// All runs of a machine.
    ///
    /// # Errors
    /// As [`Recorder::run`].
    pub fn runs(&self, machine: &Machine, tree: &Value) -> Result<Vec<Clean>, String> {
        let runs = machine.runs.par_iter();
        runs.map(|run| self.run(machine, tree, run)).collect()
    }

    /// Writes the runs of case `number` with noise and resolution into `folder`: recordings.yaml and
    /// one file per run.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(
        &self,
        machine: &Machine,
        clean: &[Clean],
        noise: f64,
        number: u64,
        folder: &Path,
    ) -> Result<(), Error> {
        std::fs::create_dir_all(folder).map_err(|error| Error::file(folder, error))?;
        let mut listed = Vec::new();
        for (i, (run, clean)) in machine.runs.iter().zip(clean).enumerate() {
            let mut random = stream(self.seed, number * 1000 + i as u64, Purpose::Noise);
            let (sensors, throws) = (clean.recorders(noise), machine.throws());
            let channels = simulate::measure(&clean.record, &sensors, &throws, &mut random);
            let file = format!("{}.parquet", run.id);
            let table = table(self.settings.sample_rate, &channels)?;
            let path = folder.join(&file);
            WholeFile::create(&path.with_extension("part"), &path)
                .and_then(|out| parquet::write_table(out, &table, ROWS_PER_GROUP))
                .and_then(WholeFile::commit)?;
            listed.push(self.listed(run, file, &channels));
        }
        let content = Written {
            format: "clearance recordings 1",
            machine: &machine.section,
            runs: listed,
        };
        let text = input::yaml::to_string(&serde_json::to_value(content)?)?;
        WholeFile::write(&folder.join(bundle::FILE), &text)?;
        Ok(())
    }

    /// A run as recordings.yaml lists it.
    fn listed(&self, run: &RunConditions, file: String, channels: &[Channel]) -> ListedRun {
        let mut conditions = run.section.clone();
        let angles: Vec<f64> = channels[0].samples.iter().map(|x| f64::from(*x)).collect();
        // The mean speed of a free crank is what the encoder says, to a tenth.
        if conditions.contains_key("speed_reference_rpm")
            && let Ok(angle) = CrankAngle::from_encoder(&angles)
        {
            let rpm = 60.0 * self.settings.sample_rate / angle.samples_per_revolution();
            conditions.insert("speed_rpm".into(), ((10.0 * rpm).round() / 10.0).into());
        }
        let time = ListedChannel {
            name: "time".into(),
            column: "t_s".into(),
            unit: "s".into(),
        };
        let others = channels.iter().map(|channel| {
            let [name, unit] = words(&channel.name);
            let column = channel.name.clone();
            ListedChannel { name, column, unit }
        });
        ListedRun {
            id: run.id.clone(),
            file,
            conditions,
            sample_rate_hz: self.settings.sample_rate,
            samples: angles.len(),
            revolutions: self.settings.revolutions,
            channels: std::iter::once(time).chain(others).collect(),
        }
    }
}

/// The content of recordings.yaml.
#[derive(Serialize)]
struct Written<'a> {
    format: &'static str,
    machine: &'a Value,
    runs: Vec<ListedRun>,
}

#[derive(Serialize)]
struct ListedRun {
    id: String,
    file: String,
    #[serde(flatten)]
    conditions: Map<String, Value>,
    sample_rate_hz: f64,
    samples: usize,
    revolutions: u32,
    channels: Vec<ListedChannel>,
}

#[derive(Serialize)]
struct ListedChannel {
    name: String,
    column: String,
    unit: String,
}

impl Clean {
    /// How far it is from the same run of another machine: the greatest ratio of the difference's RMS
    /// to the run's own, over the channels.
    pub fn differs(&self, other: &Self) -> f64 {
        let series = self.record.series.iter().zip(&other.record.series);
        let ratio = series.map(|(a, b)| {
            let square = |of: &dyn Fn(usize) -> f64| (0..a.len()).map(|i| of(i).powi(2)).sum();
            let [difference, own]: [f64; 2] = [square(&|i| a[i] - b[i]), square(&|i| a[i])];
            (difference / own.max(f64::MIN_POSITIVE)).sqrt()
        });
        ratio.fold(0.0, f64::max)
    }

    /// Its sensors with noise and resolution.
    fn recorders(&self, noise: f64) -> Vec<Sensor> {
        let sensors = self.sensors.iter().zip(&self.record.series);
        let recorder = |(sensor, series): (&Sensor, &Vec<f64>)| {
            let mut sensor = sensor.clone();
            let greatest = series.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let level = match sensor.measured {
                Measured::CrankAngle => 0.0,
                Measured::CylinderPressure { .. } => PRESSURE_NOISE * noise,
                _ => noise,
            };
            sensor.chain.noise = (level > 0.0).then_some(Noise {
                level: NoiseLevel::OfSignal(level),
                pink_share: PINK,
            });
            sensor.chain.range = match greatest > 0.0 {
                true => Some(Range::Fixed(RANGE[1] * greatest)),
                false => Some(Range::Fixed(RANGE[0])),
            };
            sensor.chain.bits = Some(BITS);
            sensor
        };
        sensors.map(recorder).collect()
    }
}

/// Name and unit of a column, as bundles have them.
fn words(column: &str) -> [String; 2] {
    let (throw, quantity) = match column.split_once('.') {
        Some((throw, quantity)) => (format!("{throw} "), quantity),
        None => (String::new(), column),
    };
    let [name, unit] = match quantity {
        "crank_angle_rad" => ["crank angle", "rad"],
        "cylinder_pressure_pa" => ["cylinder pressure", "Pa"],
        _ => ["crosshead acceleration", "m/s2"],
    };
    [throw + name, unit.to_owned()]
}

fn table(sample_rate: f64, channels: &[Channel]) -> Result<Table, recordings::Error> {
    let count = channels.first().map_or(0, |channel| channel.samples.len());
    let times = (0..count).map(|i| Some(i as f64 / sample_rate));
    let mut columns = vec![Column::new("t_s", Kind::Real, "time since the first sample").unit("s")];
    let mut data = vec![Data::Real(times.collect())];
    for channel in channels {
        let about = "as the sensor reads it";
        columns.push(Column::new(&channel.name, Kind::Real, about).unit(&channel.unit));
        let samples = channel.samples.iter().map(|x| Some(f64::from(*x)));
        data.push(Data::Real(samples.collect()));
    }
    Table::from_columns(Schema::new(columns)?, data)
}
