//! What is to be fitted to what.

use crate::crank_motion::CrankMotion;
use crate::error::Error;
use crate::meter::Meter;
use crate::observation::Observation;
use crate::parameter::Parameter;
use input::MachineFile;
use input::Resolved;
use input::paths;
use mechanism::drive::Drive;
use serde_json::Value;
use simulate::{Axis, ChamberEnd, Measured, Moved, Sensor};
use std::fmt;

/// A machine file, the values of it that are free, and the runs that they must explain.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The machine file.
    pub tree: Value,
    /// What is fitted.
    pub parameters: Vec<Parameter>,
    /// The runs.
    pub runs: Vec<Observation>,
    /// What turns their cranks.
    pub crank: CrankMotion,
    /// What its predictions have cost.
    pub meter: Meter,
}

/// Step of a coordinate over which a machine's derivative is taken. What follows from a parameter
/// in the machine file is smooth, and rounding stays far below the fit's accuracy.
const STEP: f64 = 1e-6;

impl Problem {
    /// The machine of a run, with the parameters at these coordinates.
    ///
    /// # Errors
    /// Values that do not go together.
    pub fn machine(&self, run: &Observation, coordinates: &[f64]) -> Result<Resolved, Error> {
        let mut tree = self.tree.clone();
        // What the run says comes first: a fitted clearance overrides a believed one.
        for (path, value) in &run.settings {
            paths::set(&mut tree, path, value.clone())?;
        }
        for (parameter, x) in self.parameters.iter().zip(coordinates) {
            parameter.write_for(&run.id, &mut tree, parameter.value(*x))?;
        }
        let mut machine = MachineFile::from_tree(&tree)?.resolve()?;
        machine.sensors = sensors(&machine, run);
        if self.crank == CrankMotion::Recorded {
            machine.speed = run.crank.speed;
            machine.machine.drive = Drive::Given(run.crank.clone());
        }
        Ok(machine)
    }

    /// By how much the recorded crank angle of a run is ahead of the crank at these coordinates,
    /// rad, and the derivative by each coordinate.
    pub(crate) fn crank_angle_offset(&self, run: &Observation, x: &[f64]) -> (f64, Vec<f64>) {
        let each = self.parameters.iter().zip(x).map(|(parameter, x)| {
            match parameter.is_crank_angle_offset() && parameter.holds_in(&run.id) {
                true => (
                    parameter.value(*x),
                    parameter.value(x + 1.0) - parameter.value(*x),
                ),
                false => (0.0, 0.0),
            }
        });
        let (values, slopes): (Vec<f64>, Vec<f64>) = each.unzip();
        (values.iter().sum(), slopes)
    }

    /// The machine of a run with the parameters of each group moved by [`Problem::step`] in turn.
    pub(crate) fn moved(
        &self,
        run: &Observation,
        x: &[f64],
        groups: &[Vec<usize>],
    ) -> Result<Vec<Moved>, Error> {
        let of = |group: &Vec<usize>| {
            let mut x = x.to_vec();
            group.iter().for_each(|i| x[*i] += STEP);
            let moved = self.machine(run, &x)?;
            Ok(Moved {
                machine: moved.machine,
                sensors: moved.sensors,
            })
        };
        groups.iter().map(of).collect()
    }

    /// Parameters whose derivatives can be taken together, because throws hardly feel each other
    /// through the crank. A group has one parameter of each throw (Curtis, Powell and Reid 1974).
    pub(crate) fn independent(&self) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for i in 0..self.parameters.len() {
            let apart = |j: &usize| match [i, *j].map(|k| throw(&self.parameters[k].path)) {
                [Some(a), Some(b)] => a != b,
                _ => false,
            };
            match groups.iter_mut().find(|group| group.iter().all(apart)) {
                Some(group) => group.push(i),
                None => groups.push(vec![i]),
            }
        }
        groups
    }

    /// By how much coordinates are moved for derivatives.
    pub(crate) fn step(&self) -> f64 {
        STEP
    }

    /// The machine file with the parameters at these coordinates.
    ///
    /// # Errors
    /// Where the file does not have a path.
    pub fn fitted(&self, coordinates: &[f64]) -> Result<Value, Error> {
        let mut tree = self.tree.clone();
        for (parameter, x) in self.parameters.iter().zip(coordinates) {
            parameter.write(&mut tree, parameter.value(*x))?;
        }
        Ok(tree)
    }

    /// What the parameters of one run alone come to at these coordinates: paths of the machine file
    /// and their values in this run.
    ///
    /// # Errors
    /// Where the file does not have a path.
    pub fn conditions(
        &self,
        run: &str,
        coordinates: &[f64],
    ) -> Result<Vec<(String, Value)>, Error> {
        let parameters = self.parameters.iter().zip(coordinates);
        let own =
            parameters.filter(|(parameter, _)| parameter.run.is_some() && parameter.holds_in(run));
        let own: Vec<_> = own.collect();
        let mut tree = self.tree.clone();
        let stated = self.runs.iter().filter(|other| other.id == run);
        for (path, value) in stated.flat_map(|run| &run.settings) {
            paths::set(&mut tree, path, value.clone())?;
        }
        for (parameter, x) in &own {
            parameter.write_for(run, &mut tree, parameter.value(**x))?;
        }
        let places = own.iter().flat_map(|(parameter, _)| &parameter.places);
        let values = places.map(|place| {
            let value = paths::get(&tree, place)?.cloned().unwrap_or_default();
            Ok((place.clone(), value))
        });
        values.collect()
    }

    /// The same problem with these runs.
    pub fn with_runs(&self, keep: impl Fn(&Observation) -> bool) -> Self {
        Self {
            runs: self.runs.iter().filter(|run| keep(run)).cloned().collect(),
            ..self.clone()
        }
    }

    /// The numbers that `work` gives at the coordinates `x`, or gave before. `what` distinguishes them from others of
    /// the same problem.
    pub(crate) fn once(
        &self,
        what: &dyn fmt::Debug,
        x: &[f64],
        work: impl FnOnce() -> Vec<f64>,
    ) -> Vec<f64> {
        self.meter.once(&(what, x, self), work)
    }

    /// The same at each of several points: `work` gets those that are not known from before.
    pub(crate) fn once_each(
        &self,
        what: &dyn fmt::Debug,
        all: &[Vec<f64>],
        work: impl FnOnce(&[Vec<f64>]) -> Vec<Vec<f64>>,
    ) -> Vec<Vec<f64>> {
        let inputs: Vec<_> = all.iter().map(|x| (what, &x[..], self)).collect();
        self.meter.once_each(&inputs, |missing| {
            let unknown: Vec<Vec<f64>> = missing.iter().map(|i| all[*i].clone()).collect();
            work(&unknown)
        })
    }

    /// Takes over on which motion each run of another problem is.
    pub(crate) fn take_over_branches(&mut self, other: &Self) {
        for run in &mut self.runs {
            let same = other.runs.iter().find(|other| other.id == run.id);
            run.warm_start = same.and_then(|other| other.warm_start.clone());
        }
    }

    /// The same problem with a meter of its own.
    #[must_use]
    pub fn metered(&self) -> Self {
        Self {
            meter: Meter::default(),
            ..self.clone()
        }
    }

    /// The same problem with only the parameters of these indices free.
    pub fn with_parameters(&self, keep: &[usize]) -> Self {
        Self {
            parameters: keep.iter().map(|i| self.parameters[*i].clone()).collect(),
            ..self.clone()
        }
    }
}

/// The throw whose values alone stand at a path.
pub(crate) fn throw(path: &str) -> Option<&str> {
    let throw = path.strip_prefix("throws.")?.split('.').next();
    throw.filter(|throw| *throw != "*")
}

/// The columns that a machine's runs can be compared in.
pub fn columns(machine: &Resolved) -> Vec<String> {
    let names = names(machine);
    measurable(machine)
        .iter()
        .map(|measured| measured.column(&names))
        .collect()
}

pub(crate) fn names(machine: &Resolved) -> Vec<&str> {
    let throws = machine.machine.throws.iter();
    throws.map(|t| t.name.as_str()).collect()
}

pub(crate) fn measurable(machine: &Resolved) -> Vec<Measured> {
    let throws = 0..machine.machine.throws.len();
    let of_throw = |throw| {
        [
            Measured::CrossheadAcceleration { throw },
            Measured::CylinderPressure {
                throw,
                end: ChamberEnd::Head,
            },
            Measured::CylinderPressure {
                throw,
                end: ChamberEnd::Crank,
            },
        ]
    };
    let mut all: Vec<Measured> = throws.flat_map(of_throw).collect();
    all.extend(on_structures(machine));
    for sensor in &machine.sensors {
        if !all.contains(&sensor.measured) && sensor.measured != Measured::CrankAngle {
            all.push(sensor.measured);
        }
    }
    all
}

/// What sensors on the frame and on the housings of the guides would see, where the machine has these.
fn on_structures(machine: &Resolved) -> Vec<Measured> {
    let mut all = Vec::new();
    let axes = [Axis::X, Axis::Y];
    if machine.machine.frame.is_some() {
        all.extend(axes.map(|axis| Measured::FrameAcceleration { axis }));
        all.extend(axes.map(|axis| Measured::FrameVelocity { axis }));
    }
    for (throw, of_throw) in machine.machine.throws.iter().enumerate() {
        if of_throw.housing.is_some() {
            all.extend(axes.map(|axis| Measured::HousingAcceleration { throw, axis }));
            all.extend(axes.map(|axis| Measured::HousingVelocity { throw, axis }));
        }
    }
    all
}

/// The sensors of a run's channels, in their order, and the crank angle last. They are those of the machine
/// file where it has them, perfect ones elsewhere, with the effects on both.
fn sensors(machine: &Resolved, run: &Observation) -> Vec<Sensor> {
    let names = names(machine);
    let all = measurable(machine);
    let of_column = |column: &str| {
        let measured = *all.iter().find(|m| m.column(&names) == column)?;
        let given = machine.sensors.iter().find(|s| s.measured == measured);
        Some(
            given
                .cloned()
                .unwrap_or_else(|| machine.perfect_sensor(measured)),
        )
    };
    let channels = run.channels.iter();
    let mut sensors: Vec<Sensor> = channels.filter_map(|c| of_column(&c.column)).collect();
    sensors.push(machine.perfect_sensor(Measured::CrankAngle));
    sensors
}
