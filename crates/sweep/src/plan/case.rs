//! One case of a sweep.

use std::f64::consts::PI;

use input::Resolved;
use mechanism::Machine;
use mechanism::gas::Cylinder;
use mechanism::lift::Lift;
use scalar::random::{Purpose, Stream, stream};
use serde_json::Value;
use sha2::{Digest, Sha256};
use simulate::{ExponentSettings, Extent, Motion, Settings};

use crate::digits::{COMPARED, rounded};
use crate::labels::Labels;
use crate::split::Split;
use crate::sweep_file::Windows;

/// One case: a machine at an operating point, how it is run, and what it is called.
#[derive(Clone, Debug)]
pub struct Case {
    /// Position in the sweep, from 0.
    pub index: u64,
    /// Name that never changes for the same sweep: `case-000042`.
    pub id: String,
    /// Which repeat this is, from 0; repeats differ in noise alone.
    pub repeat: u64,
    /// The machine file of this case.
    pub tree: Value,
    /// The same in SI units: machine, sensors, normal clearances.
    pub resolved: Resolved,
    /// How it is run.
    pub settings: Settings,
    /// How its motion is judged from the equations, where the sweep asks for that.
    pub judgement: Option<Judgement>,
    /// What was found, once the case has been simulated; none where nothing moves freely.
    pub motion: Option<Motion>,
    /// How the recording is cut; one window, all of it, if there are no windows.
    pub windows: Option<Windows>,
    /// Which joints are faulty.
    pub labels: Labels,
    /// Speed and pressures.
    pub operating_point: OperatingPoint,
    /// The same for all cases of a sweep that differ in noise and sensors alone.
    pub group: u64,
    /// The split of this case and its whole group.
    pub split: Split,
    /// Seed of the sweep. Noise is drawn from [`Case::noise`].
    pub seed: u64,
}

/// How the motion of a case is judged from the equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// How long and how accurately it is followed.
    pub settings: ExponentSettings,
    /// Which exponents are computed.
    pub extent: Extent,
    /// True where the running average of the largest exponent is a column.
    pub convergence: bool,
}

impl Case {
    /// The stream of random numbers for the noise of this case's sensors.
    pub fn noise(&self) -> Stream {
        stream(self.seed, self.index, Purpose::Noise)
    }
}

/// Speed and line pressures of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatingPoint {
    /// Speed of the crank, or reference speed of a free one, rev/min.
    pub speed_rpm: f64,
    /// Suction and discharge pressure of each throw, absolute, Pa.
    pub pressures_pa: Vec<[f64; 2]>,
    /// Gas load: discharge less suction pressure times the area of the piston, of the throw where that is largest, N.
    pub gas_load_n: f64,
}

impl OperatingPoint {
    pub(super) fn new(case: &Resolved) -> Self {
        let cylinders = case.machine.throws.iter().map(|throw| &throw.cylinder);
        let load = |cylinder: &Cylinder<f64>| {
            (cylinder.discharge - cylinder.suction) * PI * cylinder.piston_radius.powi(2)
        };
        Self {
            speed_rpm: rpm(case.speed),
            pressures_pa: (cylinders.clone())
                .map(|cylinder| [cylinder.suction, cylinder.discharge])
                .collect(),
            gas_load_n: cylinders.map(load).fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

/// A speed in rad/s as rev/min, to the digits that are compared: the way there and back rounds, and who looks for
/// the cases at 500 rpm must find them.
pub(super) fn rpm(speed: f64) -> f64 {
    rounded(speed * 30.0 / PI, COMPARED)
}

/// A number that stands for the physics of a case: the machine without sensors and names, and how
/// it is run.
///
/// It is the start of the SHA-256 of the machine's debug text, which holds every number to the digits that are
/// compared, names every law, and says nothing about joints that are ideal.
pub(super) fn group(case: &Resolved, settings: &Settings) -> u64 {
    let machine: Machine = Machine::lift(&[&case.machine], &mut |x| rounded(x[0], COMPARED));
    let text = format!("{machine:?} {settings:?}");
    let digest = Sha256::digest(text.as_bytes());
    digest
        .iter()
        .take(8)
        .fold(0, |group, byte| group << 8 | u64::from(*byte))
}
