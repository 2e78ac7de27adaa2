//! From machine to record: transient, sampling, energy ledger.

use crate::asked::Asked;
use crate::error::Error;
use crate::record::Record;
use crate::sensor::Sensor;
use crate::settings::Settings;
use crate::task::{Kept, Task};
use mechanism::Machine;
use std::ops::ControlFlow;

/// Runs `machine` and records `sensors`; with `traced` also the motion itself.
///
/// # Errors
/// Where the integration cannot meet its tolerance, or the settings or a sensor's filter do not fit the
/// sample rate. Where a free crank does not keep its speed, or the energy ledger of a traced run does not
/// close.
pub fn simulate(
    machine: &Machine,
    sensors: &[Sensor],
    settings: &Settings,
    traced: bool,
) -> Result<Record, Error> {
    simulate_later(machine, sensors, settings, 0.0, traced)
}

/// As [`simulate`], with a record that begins `delay` seconds (0 or more) after the transient. Without a
/// delay a crank of given speed starts the record at angle 0.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_later(
    machine: &Machine,
    sensors: &[Sensor],
    settings: &Settings,
    delay: f64,
    traced: bool,
) -> Result<Record, Error> {
    let asked = Asked::from_rest(machine, sensors, settings);
    let kept = if traced { Kept::Trace } else { Kept::Series };
    Task::start(asked, delay, kept)?.finish(&mut |_| ControlFlow::Continue(()))
}

/// As [`simulate`] with a trace; after each step `watch` receives the share of the run that is done, and a
/// break ends the run.
///
/// # Errors
/// As [`simulate`]; [`integrate::Error::Stopped`] where `watch` ends it.
pub fn simulate_watched(
    machine: &Machine,
    sensors: &[Sensor],
    settings: &Settings,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Record, Error> {
    let asked = Asked::from_rest(machine, sensors, settings);
    Task::start(asked, 0.0, Kept::Trace)?.finish(watch)
}
