//! Recordings whose truth is known: made from the machine and the runs of a bundle, with other contact
//! parameters and noise.
//!
//! Contact parameters are drawn between 0.6 and 1.4 times their nominal values.

use super::recording::{Clean, clean, noisy};
use calibrate::run_condition::CRANK_ANGLE_OFFSET;
use calibrate::{CrankMotion, Observation, Parameter, Problem};
use input::bundle::Bundle;
use input::paths;
use rand::RngExt;
use scalar::random::{Purpose, stream};
use serde_json::Value;
use simulate::{ChamberEnd, Measured};
use std::error::Error;
use std::path::Path;

/// A machine with its runs, and what is fitted of it.
pub struct Bench {
    pub tree: Value,
    pub runs: Vec<(String, Vec<(String, Value)>)>,
    pub parameters: Vec<Parameter>,
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
                clean(id, settings, &tree, &measured(&tree)?)
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

/// Acceleration and pressure of every throw.
fn measured(tree: &Value) -> Result<Vec<Measured>, Box<dyn Error>> {
    let machine = input::MachineFile::from_tree(tree)?.resolve()?;
    let of_throw = |throw| {
        let end = ChamberEnd::Head;
        [
            Measured::CrossheadAcceleration { throw },
            Measured::CylinderPressure { throw, end },
        ]
    };
    Ok((0..machine.machine.throws.len())
        .flat_map(of_throw)
        .collect())
}
