//! What the user of a machine looks at first in a run: p-V cards, rod loads, overall vibration.

use features::overall_vibration;
use mechanism::Machine;
use serde::Serialize;
use signal::angle_resampling::AngleGrid;
use signal::channel::Channel;
use signal::crank_angle::CrankAngle;
use signal::overall_vibration::OverallVibration;
use simulate::rod_load::{LOWEST_REVERSED_SHARE, SHORTEST_REVERSAL};
use simulate::sensors::ChamberEnd;
use simulate::{Chamber, IndicatorCard, Record, RodLoad};

/// The analysis of a run.
#[derive(Clone, Debug)]
pub struct RunAnalysis {
    /// Names of the throws; empty in a machine of one.
    pub throws: Vec<String>,
    /// The p-V cards of all chambers, by the pressures in the chambers themselves.
    pub cards: Vec<IndicatorCard>,
    /// The rod load of each throw.
    pub rod_loads: Vec<RodLoad>,
    /// Overall vibration of the recorded accelerations and velocities, with the names of their channels.
    pub vibrations: Vec<(String, OverallVibration)>,
}

/// The numbers of the analysis, for programs: `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct RunSummary {
    /// Name of the machine.
    pub machine: String,
    /// Mean speed of the crank, rpm.
    pub speed_rpm: f64,
    /// The chambers of the cylinders.
    pub chambers: Vec<ChamberSummary>,
    /// The combined rod load of each throw.
    pub rod_load: Vec<RodLoadSummary>,
    /// Overall vibration of each acceleration and velocity.
    pub vibration: Vec<VibrationSummary>,
}

/// A chamber of a [`RunSummary`].
#[derive(Clone, Debug, Serialize)]
pub struct ChamberSummary {
    /// Its throw; empty in a machine of one.
    pub throw: String,
    /// `head` or `crank`.
    pub end: &'static str,
    /// Power that the piston gives to the gas, W.
    pub indicated_power_w: f64,
    /// Work of a revolution over the swept volume, Pa.
    pub indicated_mean_pressure_pa: f64,
    /// Work of a revolution, J.
    pub work_per_revolution_j: f64,
}

/// A rod load of a [`RunSummary`]. Tension is positive.
#[derive(Clone, Debug, Serialize)]
pub struct RodLoadSummary {
    /// Its throw; empty in a machine of one.
    pub throw: String,
    /// Largest tension, N.
    pub max_n: f64,
    /// Largest compression, N, as a negative number.
    pub min_n: f64,
    /// Longest crank angle in tension, degrees.
    pub tension_angle_deg: f64,
    /// Longest crank angle in compression, degrees.
    pub compression_angle_deg: f64,
    /// The shorter of the two, degrees.
    pub reversal_angle_deg: f64,
    /// The smaller of the peaks in tension and in compression over the larger.
    pub reversed_share: f64,
    /// Shortest angle that API 618 allows, degrees.
    pub least_reversal_angle_deg: f64,
    /// Lowest share that API 618 allows.
    pub least_reversed_share: f64,
    /// Whether the load reverses as API 618 asks for.
    pub reverses: bool,
}

/// Overall vibration of a [`RunSummary`].
#[derive(Clone, Debug, Serialize)]
pub struct VibrationSummary {
    /// The channel.
    pub channel: String,
    /// RMS of the acceleration in the band of overall vibration, m/s².
    pub acceleration_rms_m_s2: f64,
    /// RMS of the velocity, m/s.
    pub velocity_rms_m_s: f64,
    /// RMS of the displacement, m.
    pub displacement_rms_m: f64,
}

impl RunAnalysis {
    /// Of a traced run of `machine` with these recorded channels.
    ///
    /// # Errors
    /// A record of less than one revolution, without a trace, or of a crank that turns back.
    pub fn new(
        machine: &Machine,
        record: &Record,
        channels: &[Channel],
    ) -> Result<Self, signal::Error> {
        let Some(trace) = &record.trace else {
            return Err(signal::Error::TooFewSamples { needed: 1, got: 0 });
        };
        let chambers = Chamber::of_machine(machine);
        let rate = record.sample_rate * trace.stride as f64;
        let recorded = trace.crank_angle.iter().step_by(trace.stride.max(1));
        let angle = CrankAngle::from_encoder(&recorded.copied().collect::<Vec<_>>())?;
        let grid = AngleGrid::as_fine_as_recorded(&angle)?;
        let vibrations = ["m/s^2", "m/s"];
        let vibrating = (channels.iter()).filter(|c| vibrations.contains(&c.unit.as_str()));
        let vibration = |channel: &Channel| {
            let x: Vec<f64> = channel.samples.iter().map(|x| f64::from(*x)).collect();
            let overall = overall_vibration(&x, &channel.unit, record.sample_rate, &grid)?;
            Ok((channel.name.clone(), overall))
        };
        Ok(Self {
            throws: machine.throws.iter().map(|t| t.name.clone()).collect(),
            cards: IndicatorCard::of_run(&chambers, trace, rate)?,
            rod_loads: RodLoad::of_run(machine, trace)?,
            vibrations: vibrating.map(vibration).collect::<Result<_, _>>()?,
        })
    }

    /// The numbers, of the machine of this name at this mean speed, rad/s.
    pub fn summary(&self, machine: &str, mean_speed: f64) -> RunSummary {
        let throw = |index: usize| self.throws.get(index).cloned().unwrap_or_default();
        let chambers = self.cards.iter().map(|card| ChamberSummary {
            throw: throw(card.chamber.throw),
            end: end_name(card.chamber.end),
            indicated_power_w: card.power,
            indicated_mean_pressure_pa: card.mean_pressure,
            work_per_revolution_j: card.work,
        });
        let rod_load = self.rod_loads.iter().enumerate().map(|(i, load)| {
            let reversal = load.reversal();
            RodLoadSummary {
                throw: throw(i),
                max_n: load.max(),
                min_n: load.min(),
                tension_angle_deg: reversal.tension.angle.to_degrees(),
                compression_angle_deg: reversal.compression.angle.to_degrees(),
                reversal_angle_deg: reversal.angle().to_degrees(),
                reversed_share: reversal.share(),
                // A whole number of degrees, but for rounding.
                least_reversal_angle_deg: SHORTEST_REVERSAL.to_degrees().round(),
                least_reversed_share: LOWEST_REVERSED_SHARE,
                reverses: reversal.is_sufficient(),
            }
        });
        let vibration = self
            .vibrations
            .iter()
            .map(|(channel, overall)| VibrationSummary {
                channel: channel.clone(),
                acceleration_rms_m_s2: overall.acceleration,
                velocity_rms_m_s: overall.velocity,
                displacement_rms_m: overall.displacement,
            });
        RunSummary {
            machine: machine.to_owned(),
            speed_rpm: mean_speed.to_degrees() / 6.0,
            chambers: chambers.collect(),
            rod_load: rod_load.collect(),
            vibration: vibration.collect(),
        }
    }
}

/// The end of a cylinder, for programs.
pub fn end_name(end: ChamberEnd) -> &'static str {
    match end {
        ChamberEnd::Head => "head",
        ChamberEnd::Crank => "crank",
    }
}
