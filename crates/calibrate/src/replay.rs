//! A run simulated in place of its recording: at the same instants, the crank where it was.

use crate::error::Error;
use crate::few_revolutions;
use crate::likelihood::{misfit, residuals};
use crate::observation::{self, Observation, POINTS, Run};
use crate::prediction::Prediction;
use crate::problem::Problem;
use input::Resolved;
use mechanism::drive::Drive;
use signal::angle_resampling::AngleGrid;
use signal::crank_angle::{CrankAngle, unwrap};
use signal::order_lines::OrderLines;
use signal::synchronous_average::SynchronousAverage;
use simulate::{LONGEST_PERIOD, Settings, Transient, simulate, simulate_later};
use std::f64::consts::TAU;

/// Relative local error of the integration.
const TOLERANCE: f64 = 1e-9;
/// Change from revolution to revolution at which a motion counts as settled, and revolutions that
/// it is given.
const SETTLED: f64 = 1e-7;
const AT_MOST: u32 = 100;
/// Share of a signal's mean square up to which what does not repeat every revolution is passed over;
/// resampling leaves 1e-8.
const EVERY_REVOLUTION: f64 = 1e-6;

/// What the model has in place of a recording.
#[derive(Clone, Debug)]
pub struct Replay {
    /// Crank angle at every sample, rad in [0, 2π).
    pub crank_angle: Vec<f64>,
    /// The simulated channels, those of the observation.
    pub channels: Vec<Replayed>,
    /// True where the motion repeats itself. Otherwise only what it does on average can be compared.
    pub periodic: bool,
    /// Mean speed of the recording, rpm.
    pub recorded_rpm: f64,
    /// Mean speed of the simulation, rpm.
    pub simulated_rpm: f64,
    /// RMS of the simulated crank angle's difference from the recorded one, rad.
    pub angle_difference: f64,
    /// Misfit of the whole run, in units of its noise.
    pub misfit: f64,
}

/// A channel of the model, and how far it is from the recorded one.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// Name of its column.
    pub column: String,
    /// The samples, without noise, SI.
    pub samples: Vec<f64>,
    /// RMS of the recording about its mean, SI.
    pub recording_rms: f64,
    /// RMS over the crank angle of the difference of the synchronous means, SI. The mean over the
    /// revolution counts in a pressure; that of an acceleration is its sensor's.
    pub difference: f64,
    /// RMS of the noise in the recording's synchronous mean, SI.
    pub noise_floor: f64,
    /// Misfit of the synchronous mean in units of its noise: 1 where noise is all that is left.
    pub misfit: f64,
}

/// Simulates a run at the instants of its recording, with the parameters at the coordinates `x`.
/// `observation` is that of `run`.
///
/// A crank of given speed turns at the recorded mean speed and stands where the recorded one does.
/// A free crank turns as it will, and starts so that its angle agrees over the first revolution.
/// The transient is left out, and no noise is added.
///
/// # Errors
/// An invalid machine or one that cannot be integrated, or a recording without a crank angle.
pub fn replay(
    problem: &Problem,
    run: &Run,
    observation: &Observation,
    x: &[f64],
) -> Result<Replay, Error> {
    let analysis = |source| Error::Signal {
        run: run.id.clone(),
        channel: "crank_angle_rad".into(),
        source,
    };
    let failed = |source| Error::Simulation {
        run: run.id.clone(),
        source,
    };
    let first = run.channels.first();
    let first = first.ok_or(Error::Nothing("a run without channels cannot be replayed"))?;
    let recorded = observation::angle(run, first)?;
    let mut machine = problem.machine(observation, x)?;
    let place = Place::new(&recorded, run.sample_rate);
    if let Drive::Given(given) = &mut machine.machine.drive {
        given.speed = place.speed;
        machine.speed = place.speed;
    }
    let instants = Instants::new(&machine, run, recorded.angles().len());
    let offset = machine.sensors.last().map_or(0.0, |s| s.chain.angle_offset);
    let delay = match &machine.machine.drive {
        Drive::Given(given) if given.fluctuation.is_empty() => {
            (place.angle - offset).rem_euclid(TAU) / place.speed
        }
        _ => instants.delay(&machine, &recorded).map_err(failed)?,
    };
    let mut chosen = instants.record(&machine, delay).map_err(failed)?;
    let wanted = |column: &str| {
        let channel = run.channels.iter().find(|c| c.column == column);
        channel.map_or(&[][..], |c| c.samples.as_slice())
    };
    let recordings: Vec<&[f64]> = observation
        .channels
        .iter()
        .map(|c| wanted(&c.column))
        .collect();
    let mut seen = Seen::new(&chosen).map_err(analysis)?;
    let mut same = seen.repeats(&chosen.series).map_err(analysis)?;
    if chosen.settled && !same {
        same = true;
        let revolution = TAU / speed(&chosen.crank_angle, run.sample_rate).map_err(analysis)?;
        let mut least = apart(&chosen.series, &recordings);
        for shift in 1..LONGEST_PERIOD {
            let later = delay + f64::from(shift) * revolution;
            let other = instants.record(&machine, later).map_err(failed)?;
            let difference = apart(&other.series, &recordings);
            if difference < least {
                (least, chosen) = (difference, other);
            }
        }
        seen = Seen::new(&chosen).map_err(analysis)?;
    }
    let channels = observation.channels.iter().zip(chosen.series);
    let channels: Vec<(Replayed, OrderLines)> = channels
        .zip(recordings)
        .map(|((observed, samples), recording)| {
            let lines = seen.lines(&samples)?;
            let alone = Observation {
                channels: vec![observed.clone()],
                ..observation.clone()
            };
            let prediction = Prediction::new(vec![lines.clone()], same);
            let has_mean = observed.quantity().has_mean();
            let replayed = Replayed {
                column: observed.column.clone(),
                recording_rms: deviation(recording),
                difference: difference(&observed.lines, &lines, has_mean),
                noise_floor: rms_over_angle(&observed.lines.variance, has_mean),
                misfit: misfit(&residuals(&alone, &prediction, 0.0)),
                samples,
            };
            Ok((replayed, lines))
        })
        .collect::<Result<_, _>>()
        .map_err(analysis)?;
    let (channels, lines): (Vec<Replayed>, Vec<OrderLines>) = channels.into_iter().unzip();
    let prediction = Prediction::new(lines, same);
    let simulated = speed(&chosen.crank_angle, run.sample_rate).map_err(analysis)?;
    Ok(Replay {
        angle_difference: angle_difference(&chosen.crank_angle, recorded.angles()),
        channels,
        periodic: same,
        recorded_rpm: place.speed * 60.0 / TAU,
        simulated_rpm: simulated * 60.0 / TAU,
        misfit: misfit(&residuals(observation, &prediction, 0.0)),
        crank_angle: chosen.crank_angle,
    })
}

/// Where a crank stands at the first sample, and how fast it turns.
struct Place {
    /// rad.
    angle: f64,
    /// rad/s.
    speed: f64,
}

impl Place {
    /// The straight line that is nearest to the angles.
    fn new(angle: &CrankAngle, sample_rate: f64) -> Self {
        let angles = angle.angles();
        let middle = (angles.len() - 1) as f64 / 2.0;
        let mean = angles.iter().sum::<f64>() / angles.len() as f64;
        let (mut product, mut square) = (0.0, 0.0);
        for (i, angle) in angles.iter().enumerate() {
            let at = i as f64 - middle;
            product += at * (angle - mean);
            square += at * at;
        }
        let per_sample = product / square;
        Self {
            angle: mean - per_sample * middle,
            speed: per_sample * sample_rate,
        }
    }
}

/// When a recording looks at its machine.
struct Instants {
    settings: Settings,
    count: usize,
}

/// What the sensors of a machine see at these instants.
struct Shown {
    crank_angle: Vec<f64>,
    series: Vec<Vec<f64>>,
    settled: bool,
}

impl Instants {
    fn new(machine: &Resolved, run: &Run, count: usize) -> Self {
        let revolution = TAU / machine.speed.abs();
        let length = count as f64 / run.sample_rate;
        Self {
            settings: Settings {
                transient: Transient::Settled {
                    change: SETTLED,
                    at_most: AT_MOST,
                },
                // One to spare: rounding must not lose the last sample.
                revolutions: (length / revolution).ceil() as u32 + 1,
                sample_rate: run.sample_rate,
                inner_rate: Settings::default().inner_rate,
                tolerance: TOLERANCE,
            },
            count,
        }
    }

    fn record(&self, machine: &Resolved, delay: f64) -> Result<Shown, simulate::Error> {
        let (sensors, settings) = (&machine.sensors, &self.settings);
        let mut record = simulate_later(&machine.machine, sensors, settings, delay, false)?;
        for series in &mut record.series {
            series.truncate(self.count);
        }
        // The sensors of a problem end with the crank angle.
        Ok(Shown {
            crank_angle: record.series.pop().unwrap_or_default(),
            series: record.series,
            settled: record.settled,
        })
    }

    /// After which time a free crank turns as the recorded one does from its first sample on. The
    /// mean difference of the two angles over the recording's first revolution is then 0.
    fn delay(&self, machine: &Resolved, recorded: &CrankAngle) -> Result<f64, simulate::Error> {
        let settings = Settings {
            revolutions: 4,
            ..self.settings
        };
        let angle_alone = machine.sensors.last().map_or(&[][..], std::slice::from_ref);
        let record = simulate(&machine.machine, angle_alone, &settings, false)?;
        let wrapped = record.series.into_iter().next().unwrap_or_default();
        let Ok(simulated) = unwrap(&wrapped) else {
            return Ok(0.0);
        };
        let last = simulated.len() - 1;
        let per_sample = (simulated[last] - simulated[0]) / last as f64;
        let at = |position: f64| {
            let before = (position.max(0.0) as usize).min(last - 1);
            let fraction = position - before as f64;
            simulated[before] + fraction * (simulated[before + 1] - simulated[before])
        };
        let first = recorded.samples_per_revolution() as usize;
        let angles = &recorded.angles()[..first.min(recorded.angles().len())];
        let mut position = (angles[0] - simulated[0]).rem_euclid(TAU) / per_sample;
        for _ in 0..ITERATIONS {
            let differences = angles
                .iter()
                .enumerate()
                .map(|(i, angle)| at(position + i as f64) - angle);
            let mean = differences.sum::<f64>() / angles.len() as f64;
            position -= (mean - TAU * (mean / TAU).round()) / per_sample;
        }
        Ok(position.max(0.0) / settings.sample_rate)
    }
}

/// Each brings the angles nearer by the share that the speed fluctuates by: a per cent or so.
const ITERATIONS: usize = 8;

/// Mean speed of wrapped angles, rad/s.
fn speed(wrapped: &[f64], sample_rate: f64) -> Result<f64, signal::Error> {
    Ok(Place::new(&CrankAngle::from_encoder(wrapped)?, sample_rate).speed)
}

/// A simulated run over its crank angle.
enum Seen {
    /// Revolutions that can be compared.
    Revolutions(AngleGrid),
    /// Too few for that.
    Few(CrankAngle),
}

impl Seen {
    fn new(shown: &Shown) -> Result<Self, signal::Error> {
        let angle = CrankAngle::from_encoder(&shown.crank_angle)?;
        if few_revolutions::is_short(&angle) {
            return Ok(Self::Few(angle));
        }
        Ok(Self::Revolutions(AngleGrid::new(&angle, POINTS)?))
    }

    fn lines(&self, samples: &[f64]) -> Result<OrderLines, signal::Error> {
        match self {
            Self::Revolutions(grid) => observation::lines(grid, samples),
            Self::Few(angle) => {
                let lines = few_revolutions::lines(angle, samples);
                let got = angle.revolutions();
                lines.ok_or(signal::Error::TooFewRevolutions { needed: 1, got })
            }
        }
    }

    /// Whether every revolution is like the next.
    fn repeats(&self, series: &[Vec<f64>]) -> Result<bool, signal::Error> {
        let Self::Revolutions(grid) = self else {
            return Ok(true);
        };
        for samples in series {
            // A channel that does not move at all has no period.
            let split = SynchronousAverage::new(&grid.resample(samples)?)?;
            if split
                .synchronous_share()
                .is_ok_and(|share| share < 1.0 - EVERY_REVOLUTION)
            {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// Mean square of the difference of each channel over that of the recording, added up.
fn apart(series: &[Vec<f64>], recordings: &[&[f64]]) -> f64 {
    let of_channel = |(a, b): (&Vec<f64>, &&[f64])| {
        let squares = a.iter().zip(b.iter()).map(|(a, b)| (a - b).powi(2));
        squares.sum::<f64>() / b.len() as f64 / deviation(b).powi(2).max(f64::MIN_POSITIVE)
    };
    series.iter().zip(recordings).map(of_channel).sum()
}

/// RMS about the mean.
fn deviation(samples: &[f64]) -> f64 {
    let count = samples.len().max(1) as f64;
    let mean = samples.iter().sum::<f64>() / count;
    let squares = samples.iter().map(|x| (x - mean).powi(2));
    (squares.sum::<f64>() / count).sqrt()
}

/// RMS over the crank angle of the difference of two synchronous means.
fn difference(observed: &OrderLines, predicted: &OrderLines, has_mean: bool) -> f64 {
    let both = observed.amplitude.iter().zip(&predicted.amplitude);
    let squares: Vec<f64> = both.map(|(a, b)| (a - b).norm_sqr()).collect();
    rms_over_angle(&squares, has_mean)
}

/// RMS over the crank angle of a signal with these squares of amplitudes (Parseval).
fn rms_over_angle(squares: &[f64], has_mean: bool) -> f64 {
    let mean = squares.first().filter(|_| has_mean).copied().unwrap_or(0.0);
    let orders = squares.iter().skip(1).sum::<f64>() / 2.0;
    (mean + orders).sqrt()
}

/// RMS of the difference of two angles, whole revolutions left out.
fn angle_difference(wrapped: &[f64], angles: &[f64]) -> f64 {
    let squares = wrapped.iter().zip(angles).map(|(a, b)| {
        let apart = a - b;
        (apart - TAU * (apart / TAU).round()).powi(2)
    });
    (squares.sum::<f64>() / angles.len().max(1) as f64).sqrt()
}
