//! One run of a machine, outside of any dataset.

use input::Resolved;
use mechanism::drive::Drive;
use scalar::random::Stream;
use signal::channel::Channel;
use simulate::{ExponentSettings, Extent, Motion, Record, Settings};
use std::ops::ControlFlow;

/// A machine, and how it is run.
#[derive(Clone, Debug)]
pub struct Asked {
    /// The machine.
    pub machine: Resolved,
    /// How it is run.
    pub settings: Settings,
    /// The random numbers of its sensors' noise.
    pub noise: Stream,
}

/// A run, simulated and measured.
#[derive(Clone, Debug)]
pub struct Run {
    /// The machine.
    pub machine: Resolved,
    /// How it was run.
    pub settings: Settings,
    /// What happened.
    pub record: Record,
    /// What its sensors read.
    pub channels: Vec<Channel>,
}

impl Asked {
    /// Simulates it; `watch` is told which share is done, and may stop it.
    ///
    /// # Errors
    /// An integration that fails, or was stopped.
    pub fn run(
        mut self,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Run, simulate::Error> {
        let (machine, sensors) = (&self.machine.machine, &self.machine.sensors);
        let record = simulate::simulate_watched(machine, sensors, &self.settings, watch)?;
        let channels = simulate::measure(&record, sensors, &machine.throw_names(), &mut self.noise);
        Ok(Run {
            machine: self.machine,
            settings: self.settings,
            record,
            channels,
        })
    }
}

impl Run {
    /// The kind of its motion from the equations, with all exponents, and over how many revolutions these were followed; none
    /// where nothing moves freely.
    ///
    /// # Errors
    /// An integration that fails.
    pub fn motion(&self) -> Result<(Option<Motion>, u32), simulate::Error> {
        let settings = ExponentSettings {
            tolerance: self.settings.tolerance,
            ..ExponentSettings::default()
        };
        let motion = simulate::machine_motion(&self.machine.machine, &settings, Extent::Spectrum)?;
        Ok((motion, settings.revolutions))
    }

    /// Mean speed of the crank, rad/s, where its motor does not hold it.
    pub fn free_speed(&self) -> Option<f64> {
        let is_free = matches!(self.machine.machine.drive, Drive::Free(_));
        is_free.then_some(self.record.mean_speed)
    }
}
