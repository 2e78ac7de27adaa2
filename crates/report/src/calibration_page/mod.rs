//! The HTML page of a calibration: what it found, how far that can be trusted, and pictures of it.
//!
//! [`CalibrationPage::read`] reads the files of a calibration.
//! [`CalibrationPage::render`] is one file with its styles and figures inside. Its size is bounded
//! for any calibration.

mod corrections;
pub(crate) mod folder;
mod gas;
pub(crate) mod misfits;
mod page;
mod parameters;
mod sensors;
mod transfers;
pub(crate) mod verdict;
pub(crate) mod waveforms;
pub(crate) mod words;

pub use gas::Pressure;

use calibrate::results::{Estimate, Results};
use std::collections::BTreeMap;

/// The content of the page.
#[derive(Clone, Debug, Default)]
pub struct CalibrationPage {
    /// Name of the machine.
    pub name: String,
    /// Version of the program that makes the page.
    pub version: String,
    /// What the calibration found.
    pub results: Results,
    /// The unit of each parameter, in their order; empty for a pure number.
    pub units: Vec<String>,
    /// The runs with their curves.
    pub runs: Vec<Run>,
    /// One revolution of pressures of each chamber, by run and column.
    pub pressures: BTreeMap<String, BTreeMap<String, Vec<Pressure>>>,
}

/// A parameter on the page.
#[derive(Clone, Copy)]
struct Parameter<'a> {
    path: &'a str,
    unit: &'a str,
    found: &'a Estimate,
}

impl CalibrationPage {
    fn parameters(&self) -> Vec<Parameter<'_>> {
        let units = self.units.iter().map(String::as_str);
        let units = units.chain(std::iter::repeat(""));
        let parameters = self.results.parameters.iter().zip(units);
        parameters
            .map(|((path, found), unit)| Parameter { path, unit, found })
            .collect()
    }

    /// Misfit of the runs that were fitted.
    fn fitted(&self) -> Misfit {
        let fit = &self.results.fit;
        Misfit {
            before: fit.nominal.unwrap_or(f64::NAN),
            after: fit.calibrated.unwrap_or(f64::NAN),
        }
    }

    /// Misfit of the runs that were held out, where there are any.
    fn held_out(&self) -> Option<Misfit> {
        let fit = &self.results.fit;
        Some(Misfit {
            before: fit.heldout_nominal?,
            after: fit.heldout_calibrated?,
        })
    }
}

impl Parameter<'_> {
    /// Whether it makes sense to state the value as a share of the nominal one: not for an angle, nor
    /// for the exponent of a clearance, whose zero means something.
    fn is_ratio(&self) -> bool {
        self.found.nominal > 0.0 && !self.path.contains(".relation.")
    }
}

/// A misfit before and after.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misfit {
    /// With the nominal parameters.
    pub before: f64,
    /// With the calibrated ones.
    pub after: f64,
}

/// A run.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Its name.
    pub id: String,
    /// True where it was predicted and not fitted to.
    pub held_out: bool,
    /// Its misfit.
    pub misfit: Misfit,
    /// Its channels.
    pub channels: Vec<Channel>,
}

/// A channel of a run.
#[derive(Clone, Debug, Default)]
pub struct Channel {
    /// Name of its column: `crosshead_acceleration_m_s2`.
    pub column: String,
    /// What stands at each crank angle.
    pub waveform: Vec<Point>,
    /// Residuals by order.
    pub orders: Vec<OrderResidual>,
    /// Label of each step of an explanation, and the simulated mean there at the crank angles of the waveform.
    pub steps: Vec<(String, Vec<f64>)>,
}

/// What stands at a crank angle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Point {
    /// Crank angle in degrees.
    pub crank_angle_deg: f64,
    /// Mean of the measured revolutions.
    pub measured: f64,
    /// Standard deviation from revolution to revolution.
    pub scatter: f64,
    /// Standard deviation of the mean.
    pub noise: f64,
    /// Simulated with the nominal parameters.
    pub before: f64,
    /// Simulated with the calibrated ones.
    pub after: f64,
}

/// Difference of an order's amplitude, in standard deviations of its noise.
#[derive(Clone, Copy, Debug, Default)]
pub struct OrderResidual {
    /// Multiple of the crank's speed.
    pub order: f64,
    /// With the nominal parameters.
    pub before: f64,
    /// With the calibrated ones.
    pub after: f64,
}
