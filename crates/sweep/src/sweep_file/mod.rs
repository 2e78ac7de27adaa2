//! sweep.yaml: which cases to simulate, and what becomes of them.
//!
//! ```yaml
//! name: bearing-faults
//! machine: ../data/machines/single-stage.yaml
//! seed: 1
//! run: {revolutions: 20, transient: 10}
//! cases:
//!   - grid:
//!       joints: [[], [big_end], [small_end], [big_end, small_end]]
//!       clearance: [0.1 mm, 0.2 mm, 0.3 mm]
//!       speed: [350 rpm, 500 rpm]
//! vary:
//!   joints.big_end.contact.stiffness: {lognormal: {factor: 1.2}}
//! ```

pub mod axes;
pub mod bifurcation;
pub mod calibrate;
mod licence;
mod template;
pub mod together;
pub mod values;

use input::choice::{Count, Or};
use input::quantity::{AboveZero, Frequency, FromZero, Number, Part, Positive, Quantity, Ratio};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Map, Value};

pub use axes::{Axes, Block, Design, Random};
pub use bifurcation::{Bifurcation, Directions};
pub use calibrate::{Calibrate, Uncertainty, Undetermined};
pub use licence::Licence;
pub use template::template;
pub use together::{Gaussian, Together};
pub use values::{Amount, Draw, Levels, Range, Spacing, Spread, Values};

/// A sweep: its cases, the settings of each run, and the splits of the dataset.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepFile {
    /// Name of the dataset, and of its folder without `--out`: a letter or digit, then letters,
    /// digits, `-`, `_`, `.` and spaces.
    pub name: String,
    /// The published study that the cases repeat; the pages test its claims. By default none.
    #[serde(default)]
    pub study: Option<Study>,
    /// The licence of the dataset, which its card, `croissant.json` and tables state. By default its publisher has
    /// still to choose one.
    #[serde(default)]
    pub licence: Option<Licence>,
    /// The machine: path of its file, from the folder of this one, or the machine itself. With
    /// `calibrate` the default is the machine section of the bundle, at the conditions of its first
    /// run.
    #[serde(default)]
    pub machine: Option<Or<String, Map<String, Value>>>,
    /// The machine is calibrated to recordings of it before the first case.
    #[serde(default)]
    pub calibrate: Option<Calibrate>,
    /// The folder of the calibration that the machine comes from, from the folder of this file: it
    /// is copied into the dataset. A dataset's own sweep.yaml has it.
    #[serde(default)]
    pub calibrated: Option<String>,
    /// Seed of all random numbers; default 0.
    #[serde(default)]
    pub seed: Option<Count<0, { u32::MAX }>>,
    /// Settings of the run of each case.
    pub run: Run,
    /// Recordings of each case, each with other noise; default 1.
    #[serde(default)]
    pub repeats: Option<Count<1, 1_000_000>>,
    /// How each recording is cut; by default one window, the whole recording.
    #[serde(default)]
    pub windows: Option<Windows>,
    /// The cases: blocks, one after the other.
    pub cases: Vec<Block>,
    /// Unknowns that vary at random from case to case, by path in the machine file. In a path `*`
    /// stands for any key, with one value for all places. A value that a case sets is not varied.
    #[serde(default)]
    pub vary: Axes<Draw>,
    /// Unknowns that vary together.
    #[serde(default)]
    pub vary_together: Vec<Together>,
    /// Bifurcation diagrams, computed after the cases.
    #[serde(default)]
    pub bifurcations: Vec<Bifurcation>,
    /// Shares of the splits; default 70 %, 15 % and 15 %.
    #[serde(default)]
    pub splits: Splits,
    /// Format of the recordings.
    #[serde(default)]
    pub format: Format,
    /// Cases in one shard, which is finished as a whole and not simulated again after an
    /// interruption; default 256.
    #[serde(default)]
    pub shard_size: Option<Count<1, MOST_CASES_A_SHARD>>,
}

/// Most cases of one shard.
pub const MOST_CASES_A_SHARD: u32 = 1_000_000;

impl SweepFile {
    /// The paths of the machine file that it sets or varies, and the other names of axes.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        let cases = self.cases.iter().flat_map(Block::names);
        let diagrams = self.bifurcations.iter().map(|one| one.path.as_str());
        cases.chain(self.vary.names()).chain(diagrams)
    }
}

/// The JSON Schema of sweep.yaml, for editors and checks.
pub fn schema() -> Value {
    let mut schema = input::schema::generate::<SweepFile>();
    schema["title"] = "sweep.yaml".into();
    schema
}

/// Settings of the run of each case.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Revolutions that are recorded.
    pub revolutions: Count<1, 1_000_000>,
    /// Transient before the recording: a number of revolutions, or until the motion has settled;
    /// default 10 revolutions.
    #[serde(default)]
    pub transient: Option<Or<Count<0, 1_000_000>, Settled>>,
    /// Sample rate of the recordings; default that of the machine file, or 10 kHz.
    #[serde(default)]
    pub sample_rate: Option<Positive<Frequency>>,
    /// Samples in a revolution of the signals: the recordings are resampled over the crank angle, so that all are of one
    /// length. They have no sample rate then; the sensors are recorded at that of the machine file, or 10 kHz, which
    /// must give as many samples in a revolution. Features are those of the recordings before. By default signals are
    /// as recorded, at equal times.
    #[serde(default)]
    pub samples_per_revolution: Option<Count<32, 65_536>>,
    /// With `samples_per_revolution`: the crank angle at which the signals begin; default `zero`.
    #[serde(default)]
    pub start: Option<Start>,
    /// Relative local error of the integration, 1e-14 to 1e-2; default 1e-9.
    #[serde(default)]
    pub tolerance: Option<Number<AboveZero>>,
    /// The motion of each case judged from the equations: the largest Lyapunov exponent, its
    /// standard error, and the regime (columns `lyapunov_true_per_s`,
    /// `lyapunov_true_standard_error_per_s`, `lyapunov_true_per_revolution`, `regime_true`,
    /// `period_true_revolutions`, `floquet_multiplier_true`). Not computed by default; it takes
    /// about twice as long per revolution as the recording.
    #[serde(default)]
    pub lyapunov: Option<Lyapunov>,
    /// Whether the features classify the motion of each window from the signal: `regime`,
    /// `lyapunov_per_s` and related columns, entropies, dimension, recurrence. Default true. It can
    /// take as long as the simulation, so a large sweep may switch it off.
    #[serde(default)]
    pub chaos: Option<bool>,
}

/// The crank angle at which signals begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// At crank angle 0.
    Zero,
    /// At an angle that is drawn for each case.
    Random,
}

/// How the motion of each case is judged.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lyapunov {
    /// Revolutions that are averaged over; a chaotic motion needs some hundred.
    pub revolutions: Count<20, 1_000_000>,
    /// Revolutions before; default 50.
    #[serde(default)]
    pub transient: Option<Count<0, 1_000_000>>,
    /// true for all exponents, in column `lyapunov_spectrum_true_per_s`; it takes about four times
    /// as long as the largest alone for two joints with clearance.
    #[serde(default)]
    pub spectrum: bool,
    /// true for the running average of the largest exponent after each revolution, in column
    /// `lyapunov_convergence_true_per_s`.
    #[serde(default)]
    pub convergence: bool,
}

/// A transient that ends when the motion repeats itself.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Settled {
    /// Largest change from one revolution (or two, or four) to the next of an offset over its
    /// clearance, and of a rate over its scale: 1e-3, for example.
    pub until_settled: Number<AboveZero>,
    /// Revolutions after which the recording starts anyway; chaotic motion never settles.
    pub at_most: Count<1, 1_000_000>,
}

/// How a recording is cut into rows of the dataset: windows that follow on one another.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Windows {
    /// How many.
    pub count: Count<1, 100_000>,
    /// How long each is, in revolutions.
    pub revolutions: Count<1, 1_000_000>,
}

/// Shares of the splits. Together they are 100 %.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Splits {
    /// To learn from; default 0 %.
    #[serde(default)]
    pub train: Option<Quantity<Ratio, Part>>,
    /// To choose between models; default 0 %.
    #[serde(default)]
    pub validation: Option<Quantity<Ratio, Part>>,
    /// To judge the chosen one; default 0 %.
    #[serde(default)]
    pub test: Option<Quantity<Ratio, Part>>,
}

impl Splits {
    /// Train, validation, test, each from 0 to 1.
    pub fn shares(&self) -> [f64; 3] {
        [self.train, self.validation, self.test].map(|share| share.map_or(0.0, |s| s.si()))
    }
}

impl Default for Splits {
    fn default() -> Self {
        Self {
            train: Quantity::new(0.70),
            validation: Quantity::new(0.15),
            test: Quantity::new(0.15),
        }
    }
}

/// A published study whose claims are known to this program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Study {
    /// "Dynamic analysis of the moving mechanism of the reciprocating compressor with clearance
    /// joints": the same clearances at the big end, at the small end and at both.
    Paper2,
}

/// Format of the recordings. Features are always a Parquet table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// Parquet tables, one row per window.
    #[default]
    Parquet,
    /// One MCAP file per case, for Foxglove and ROS tools.
    Mcap,
}

impl Format {
    /// Its name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Format::Parquet => "parquet",
            Format::Mcap => "mcap",
        }
    }
}

/// A weight of a choice.
pub type Weight = Number<FromZero>;
