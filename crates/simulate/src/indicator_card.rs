//! The p-V card of a chamber: indicated power and indicated mean pressure.

use crate::chamber::Chamber;
use crate::sensors::ChamberEnd;
use crate::trace::Trace;
use signal::angle_resampling::{AngleGrid, Revolutions};
use signal::crank_angle::CrankAngle;
use signal::indicated_work::indicated_work;
use std::f64::consts::TAU;

/// Pressure over volume of a chamber, and what it says.
#[derive(Clone, Debug)]
pub struct IndicatorCard {
    /// The chamber.
    pub chamber: Chamber,
    /// Its volume at the crank angles 2πj/n, m³.
    pub volume: Vec<f64>,
    /// Its pressure there, the mean over the revolutions, Pa.
    pub pressure: Vec<f64>,
    /// Work that the piston does on the gas per revolution, W = −∮ p dV, J.
    pub work: f64,
    /// Indicated power, W over the time of a revolution, watts.
    pub power: f64,
    /// Indicated mean pressure, W over the swept volume, Pa.
    pub mean_pressure: f64,
}

impl IndicatorCard {
    /// Of the pressure over whole revolutions, Pa, at so many revolutions per second.
    pub fn new(chamber: &Chamber, pressure: &Revolutions, revolutions_per_s: f64) -> Self {
        let mean = pressure.synchronous_mean();
        let step = TAU / mean.len() as f64;
        let volume = (0..mean.len()).map(|j| chamber.volume(j as f64 * step));
        let work = indicated_work(pressure, |angle| chamber.volume(angle));
        Self {
            volume: volume.collect(),
            pressure: mean,
            work,
            power: work * revolutions_per_s,
            mean_pressure: work / chamber.swept_volume(),
            chamber: chamber.clone(),
        }
    }

    /// The cards of all chambers of a run, by the pressures in the chambers themselves: no sensor's
    /// noise. `trace_rate` is the trace's own sample rate, Hz.
    ///
    /// # Errors
    /// A trace of less than one revolution, or of a crank that turns back.
    pub fn of_run(
        chambers: &[Chamber],
        trace: &Trace,
        trace_rate: f64,
    ) -> Result<Vec<Self>, signal::Error> {
        let grid = grid(trace)?;
        let speed = trace_rate / grid.samples_per_revolution();
        let with_trace = chambers.iter().filter_map(|chamber| {
            let throw = trace.throws.get(chamber.throw)?;
            let pressure = match chamber.end {
                ChamberEnd::Head => Some(&throw.pressure),
                ChamberEnd::Crank => throw.crank_end_pressure.as_ref(),
            };
            Some((chamber, pressure?))
        });
        with_trace
            .map(|(chamber, pressure)| Ok(Self::new(chamber, &grid.resample(pressure)?, speed)))
            .collect()
    }
}

/// The crank angles over which a trace is averaged.
pub(crate) fn grid(trace: &Trace) -> Result<AngleGrid, signal::Error> {
    let angle = CrankAngle::from_encoder(&trace.crank_angle)?;
    AngleGrid::as_fine_as_recorded(&angle)
}
