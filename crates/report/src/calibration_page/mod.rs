//! The HTML page of a calibration: what it found, how far that can be trusted, and pictures of it.
//!
//! The caller reads what a calibration has written and fills a [`CalibrationPage`];
//! [`CalibrationPage::render`] is one file with its styles and figures inside. Its size is bounded
//! whatever the calibration.

mod corrections;
mod gas;
pub(crate) mod misfits;
mod page;
mod parameters;
mod sensors;
mod transfers;
pub(crate) mod verdict;
pub(crate) mod waveforms;
pub(crate) mod words;

pub use gas::{Chamber, Diagram, Phase, Pressure};

/// All that the page tells. Numbers are SI; misfits are in units of the recordings' noise, so that 1
/// is noise alone.
#[derive(Clone, Debug, Default)]
pub struct CalibrationPage {
    /// Name of the machine.
    pub name: String,
    /// Version of the program that makes the page.
    pub version: String,
    /// How the best fit was searched.
    pub optimiser: String,
    /// Evaluations of the model, all runs being one.
    pub evaluations: u64,
    /// False where the search was stopped before its end.
    pub complete: bool,
    /// Whether the model explains the recordings; where it does not, no interval is known.
    pub adequate: bool,
    /// Values of the data sheet that were looked at one by one because it did not.
    pub corrections: Vec<Correction>,
    /// Misfit of the runs that were fitted.
    pub fitted: Misfit,
    /// Misfit of the runs that were held out, where there are any.
    pub held_out: Option<Misfit>,
    /// What was fitted.
    pub parameters: Vec<Estimate>,
    /// Correlation between each pair of estimates, in their order.
    pub correlations: Vec<Vec<f64>>,
    /// The runs.
    pub runs: Vec<Run>,
    /// The measuring chains that the recordings show.
    pub sensors: Vec<Sensor>,
    /// The gas of each chamber whose pressure was recorded.
    pub gas: Vec<Chamber>,
    /// What the relations between clearances come to, where that was asked.
    pub transfer: Option<Transfer>,
}

/// What a machine that was calibrated at some clearances shows at others, under each relation
/// between contact parameters and clearance. Relations are `eq5`, `conformal`, `constant`, `fitted`.
#[derive(Clone, Debug, Default)]
pub struct Transfer {
    /// The relations that the recordings leave, the best first; none where they have no say.
    pub left: Vec<String>,
    /// True where runs that were held out decide, and not the fitted ones.
    pub by_held_out: bool,
    /// Each relation held against the recordings.
    pub relations: Vec<Hypothesis>,
    /// What each shows elsewhere.
    pub forecasts: Vec<Forecast>,
}

/// A relation against the recordings.
#[derive(Clone, Debug, Default)]
pub struct Hypothesis {
    /// The relation.
    pub relation: String,
    /// Exponents that were fitted: path, value and its 95 % interval.
    pub exponents: Vec<(String, Bounded)>,
    /// Misfit of the fitted runs.
    pub fitted: f64,
    /// Misfit of those held out.
    pub held_out: Option<f64>,
    /// Schwarz's criterion less that of the best relation.
    pub criterion: Option<f64>,
}

/// What the machine shows in a run under a relation.
#[derive(Clone, Debug, Default)]
pub struct Forecast {
    /// The run whose speed and pressures hold.
    pub run: String,
    /// The relation.
    pub relation: String,
    /// The clearances that are not the fitted ones, m, by the joint's path.
    pub clearances: Vec<(String, f64)>,
    /// Its channels: column, greatest magnitude over a revolution, and that of the recording.
    pub peaks: Vec<(String, Bounded, Option<f64>)>,
}

/// A value with its 95 % interval, where that is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounded {
    /// The value.
    pub value: f64,
    /// The interval.
    pub interval: Option<[f64; 2]>,
}

/// A value of the data sheet that is wrong, or may be.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correction {
    /// Its path in the machine file.
    pub path: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// The value that was stated, where one was.
    pub nominal: Option<f64>,
    /// The value that explains the recordings.
    pub value: f64,
    /// Its 95 % interval, where the recordings determine it.
    pub interval: Option<[f64; 2]>,
    /// Probability that this value is the one that is wrong.
    pub probability: f64,
    /// Misfit of the fitted runs with it.
    pub misfit: f64,
    /// Whether the calibrated machine has it.
    pub applied: bool,
}

/// The measuring chain of a channel, values in the channel's SI unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Name of its column: `crosshead_acceleration_m_s2`.
    pub column: String,
    /// Its noise.
    pub noise: Noise,
    /// Its converter.
    pub converter: Converter,
    /// Samples per second, where they are known and the runs agree.
    pub sample_rate_hz: Option<f64>,
}

/// Noise of a measuring chain.
#[derive(Clone, Debug, PartialEq)]
pub enum Noise {
    /// Its root mean square.
    Known {
        /// RMS.
        rms: f64,
        /// The same as a share of the signal's RMS, where it follows that.
        of_signal: Option<f64>,
        /// Share of its mean square that is 1/f.
        pink_share: f64,
    },
    /// An upper bound of it alone.
    AtMost {
        /// RMS.
        rms: f64,
        /// Why there is no more.
        reason: String,
    },
    /// It is not identifiable.
    Unknown {
        /// Why.
        reason: String,
    },
}

/// Converter of a measuring chain.
#[derive(Clone, Debug, PartialEq)]
pub enum Converter {
    /// One step in all runs, which tells no range.
    RangeAssumed {
        /// The step.
        resolution: f64,
        /// Bits that the recorded values need.
        bits_needed: u32,
        /// Bits that are assumed.
        bits: u32,
        /// Range that is assumed.
        range: f64,
    },
    /// The range is set to each record.
    RangePerRun {
        /// The coarsest step.
        resolution: f64,
        /// The finest step.
        finest: f64,
        /// Bits.
        bits: u32,
    },
    /// An encoder.
    Encoder {
        /// Step of the angle.
        resolution: f64,
        /// Bits to the turn.
        bits: u32,
    },
    /// Neither step nor range is identifiable.
    Unknown {
        /// Why.
        reason: String,
    },
}

/// A misfit before and after.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misfit {
    /// With the nominal parameters.
    pub before: f64,
    /// With the calibrated ones.
    pub after: f64,
}

/// What was found of a parameter.
#[derive(Clone, Debug, Default)]
pub struct Estimate {
    /// Its path in the machine file.
    pub path: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// The value before.
    pub nominal: f64,
    /// The value found; the nominal one where the recordings do not tell it.
    pub value: f64,
    /// How well it is known.
    pub known: Known,
    /// Whether the value lies at the edge of its search range.
    pub at_bound: bool,
    /// Why it is not told, in words; empty where that is not known, or where it is told.
    pub reason: String,
}

/// How well an estimate is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Known {
    /// Its 95 % interval.
    Within([f64; 2]),
    /// It was fitted with a model that does not explain the recordings: there is no interval.
    Fitted,
    /// It is not identifiable from the recordings.
    #[default]
    Nothing,
}

impl Estimate {
    /// Its 95 % interval, where there is one.
    fn interval(&self) -> Option<[f64; 2]> {
        match self.known {
            Known::Within(interval) => Some(interval),
            Known::Fitted | Known::Nothing => None,
        }
    }

    /// Whether the recordings determine it, by this model at least.
    fn is_identifiable(&self) -> bool {
        self.known != Known::Nothing
    }

    /// Whether it makes sense to state the value as a share of the nominal one: not for an angle, nor
    /// for the exponent of a clearance, whose zero means something.
    fn is_ratio(&self) -> bool {
        self.nominal > 0.0 && !self.path.contains(".relation.")
    }
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
