//! A machine at an operating point becomes a run: transient, sensors, energy ledger.

pub mod sensor;
pub mod settings;

pub use sensor::{
    Axis, Chain, ChamberEnd, LowPass, Measured, Noise, NoiseLevel, Resonance, Sensor,
};
pub use settings::{Settings, Transient};
