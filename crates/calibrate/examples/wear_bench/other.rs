//! Recordings of another program, which states the clearances.

use super::case::{Case, case};
use calibrate::{Channel, Run};
use input::bundle::Bundle;
use recordings::Table;
use recordings::formats::parquet::read_table;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::error::Error;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

/// Suction pressure of the labelled recordings, Pa.
const SUCTION: f64 = 105_000.0;

/// One run of the bundle in `folder`, of the machine in the file `machine`.
pub fn run(folder: &Path, machine: &Path, id: &str) -> Result<Case, Box<dyn Error>> {
    let bundle = Bundle::read(folder)?;
    let tree = input::machine_file::read(machine)?.to_tree().clone();
    let mut runs = calibrate::bundle::runs(&bundle, &tree, &[])?;
    runs.retain(|run| run.id == id);
    let run = runs.first().ok_or("no such run")?;
    let clearances = run.settings.iter().filter_map(|(path, value)| {
        let joint = path.strip_suffix(".clearance")?;
        let clearance = value
            .as_str()
            .and_then(|text| input::unit::parse(text).ok());
        Some((joint.to_owned(), clearance.map_or(0.0, |c| c.si)))
    });
    let truth: BTreeMap<String, f64> = clearances.collect();
    case(name(folder, id), tree, runs, truth)
}

/// The name of the case of a run of the bundle in `folder`.
pub fn name(folder: &Path, id: &str) -> String {
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    format!("{name}/{id}")
}

/// Labelled recordings of one machine.
pub struct Set {
    tree: Value,
    table: Table,
    labels: Vec<[f64; 2]>,
}

impl Set {
    /// The recordings in `folder`, of the machine in the file `machine`.
    pub fn open(folder: &Path, machine: &Path) -> Result<Self, Box<dyn Error>> {
        let labels = fs::read_to_string(folder.join("labels.csv"))?;
        let label = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            Ok([cells[2].parse()?, cells[3].parse()?])
        };
        let labels = labels.lines().skip(1).map(label);
        Ok(Self {
            tree: input::machine_file::read(machine)?.to_tree().clone(),
            table: read_table(&folder.join("labelled/recordings.parquet"))?,
            labels: labels.collect::<Result<_, Box<dyn Error>>>()?,
        })
    }

    /// The name of the case of this row.
    pub fn name(row: usize) -> String {
        format!("labelled {row}")
    }

    /// The recording of this row, from 0 on.
    pub fn case(&self, row: usize) -> Result<Case, Box<dyn Error>> {
        let number = |name: &str| -> Result<f64, Box<dyn Error>> {
            let values = self.table.values::<f64>(name)?;
            Ok(values.get(row).copied().flatten().ok_or("no such row")?)
        };
        let samples = |name: &str| -> Result<Vec<f64>, Box<dyn Error>> {
            let values = self.table.values::<Vec<f32>>(name)?;
            let samples = values
                .get(row)
                .and_then(Option::as_ref)
                .ok_or("no such row")?;
            Ok(samples.iter().map(|x| f64::from(*x)).collect())
        };
        let column = "crosshead_acceleration_m_s2";
        let speed_rpm = number("speed_rpm")?;
        let angle = samples("crank_angle_rad")?;
        let sample_rate = number("sample_rate_hz")?;
        let run = Run {
            id: format!("row {row}"),
            settings: vec![
                ("speed".into(), json!(format!("{speed_rpm} rpm"))),
                ("cylinder.suction".into(), json!(format!("{SUCTION} Pa"))),
                (
                    "cylinder.discharge".into(),
                    json!(format!("{} Pa", number("discharge_pa")?)),
                ),
            ],
            speed_rpm,
            sample_rate,
            is_timed: true,
            crank_angle: Some(angle.iter().map(|a| a.rem_euclid(2.0 * PI)).collect()),
            channels: vec![Channel {
                column: column.into(),
                samples: samples(column)?,
            }],
        };
        let truth = ["joints.big_end", "joints.small_end"].map(str::to_owned);
        let truth = truth.into_iter().zip(self.labels[row]).collect();
        case(Self::name(row), self.tree.clone(), vec![run], truth)
    }
}
