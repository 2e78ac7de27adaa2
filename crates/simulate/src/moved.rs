//! A machine with one parameter moved.

use crate::sensor::Sensor;
use mechanism::Machine;

/// A machine and its sensors with one parameter moved by one unit.
///
/// What is derived is the straight line from the machine to this one: the moved machine must have
/// the same build (laws, throws, joints clear or ideal).
#[derive(Clone, Debug)]
pub struct Moved {
    /// The machine.
    pub machine: Machine,
    /// Its sensors.
    pub sensors: Vec<Sensor>,
}
