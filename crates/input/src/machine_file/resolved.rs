//! What a machine file says, in SI units.

use super::effects::{self, Effects};
use super::normal_clearance::NormalClearance;
use super::sensors;
use super::top_sections::Sections;
use crate::error::Error;
use mechanism::Machine;
use simulate::{Chain, Measured, Sensor};

/// What sensors and effects are held against: where they can be.
const PLACES: [&str; 6] = [
    "/frame",
    "/housing",
    "/throws.*.housing",
    "/throws.*.name",
    "/cylinder.crank_end",
    "/throws.*.cylinder.crank_end",
];

/// What a machine file says.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// The machine's name.
    pub name: String,
    /// Speed of the crank, or reference speed of a free one, rad/s.
    pub speed: f64,
    /// The machine in SI units.
    pub machine: Machine,
    /// Its sensors.
    pub sensors: Vec<Sensor>,
    /// Sample rate at which it is recorded, Hz; none where the file states none.
    pub sample_rate: Option<f64>,
    /// Up to which clearances it is healthy.
    pub normal_clearance: NormalClearance,
    /// Positions of the effects of the file that cannot act, as their joint is ideal. The machine does not have them.
    pub idle_effects: Vec<usize>,
    effects: Effects,
}

impl Resolved {
    /// A sensor that is perfect but for what the effects make of it.
    pub fn perfect_sensor(&self, measured: Measured) -> Sensor {
        let chain = Chain {
            structure: measured.structure(&self.machine),
            ..Chain::default()
        };
        let mut sensor = Sensor { measured, chain };
        self.effects.sense(&mut sensor, &self.machine.throws);
        sensor
    }
}

impl Sections {
    /// The machine with its effects.
    pub(super) fn resolve(&self) -> Result<Resolved, Error> {
        let places = |error: Error| PLACES.iter().fold(error, |e, place| e.against(*place));
        let under = |error: Error| places(error.under("effects"));
        let effects = Effects::new(&self.effects).map_err(under)?;
        let mut prepared = self.clone();
        effects.prepare(&mut prepared).map_err(under)?;
        let (mut machine, normal_clearance) = prepared.machine()?;
        let idle_effects = effects::idle(&self.effects, &machine).map_err(under)?;
        effects.act(&mut machine, &idle_effects).map_err(under)?;
        let sensors = sensors::resolve(&self.sensors, &machine);
        let mut sensors = sensors.map_err(|e| places(e.under("sensors")))?;
        for sensor in &mut sensors {
            effects.sense(sensor, &machine.throws);
        }
        Ok(Resolved {
            name: self.name.clone(),
            speed: self.speed.si(),
            machine,
            sensors,
            sample_rate: self.sample_rate.map(|rate| rate.si()),
            normal_clearance,
            idle_effects,
            effects,
        })
    }
}
