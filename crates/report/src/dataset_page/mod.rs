//! The HTML page of a dataset.
//!
//! [`DatasetPage::from_dataset`] reads the tables of the dataset. [`DatasetPage::render`] is one
//! file with its styles and figures inside, for a browser or a printer. Its size is bounded for any
//! dataset: figures thin their lines, and long tables end with a count of the rows that are left
//! out.

mod captions;
mod claims;
mod comparison;
mod diagnosis;
mod distributions;
mod examples;
mod levels;
mod operation;
mod page;
mod portrait;
mod settings;

pub(crate) use examples::MOST_EXAMPLES;

use crate::case_table::CaseTable;
use crate::figure::Colour;
use crate::{Column, Level, classes};
use classify::{Baseline, RankedFeature};
use recordings::{CaseWarning, FailedCase};

/// The content of the page. Numbers are SI; labels and names are as in the data.
#[derive(Clone, Debug)]
pub struct DatasetPage {
    /// Name of the dataset.
    pub name: String,
    /// What it is, in a sentence or two.
    pub about: String,
    /// Version of the program that wrote it.
    pub version: String,
    /// Seed of the sweep.
    pub seed: u64,
    /// Rate at which the sensors are recorded, Hz.
    pub sample_rate_hz: f64,
    /// Samples in a revolution, where the channels are resampled over the crank angle.
    pub samples_per_revolution: Option<u32>,
    /// Revolutions of the crank in one window.
    pub revolutions_per_window: u32,
    /// Fewest and most samples in one window; they differ where the speed does.
    pub samples_per_window: (usize, usize),
    /// The channels, by name.
    pub channels: Vec<String>,
    /// The machine's joints, in their order.
    pub joints: Vec<String>,
    /// Names of the splits, in the order of the counts below.
    pub splits: Vec<String>,
    /// How many cases and windows there are of each fault.
    pub faults: Vec<FaultCount>,
    /// The parameters that vary, and how far.
    pub ranges: Vec<ParameterRange>,
    /// The cases that have no data.
    pub failed: Vec<FailedCase>,
    /// What is doubtful about the others.
    pub warnings: Vec<CaseWarning>,
    /// One example per fault.
    pub examples: Vec<ClassExample>,
    /// Why there is no example; empty where there are some.
    pub no_examples: String,
    /// What is compared: depends on the design of the sweep.
    pub design: Design,
    /// How levels and spectra go with speed and load.
    pub operation: Operation,
    /// How well a classifier does that is trained on it; none where it has no test or one class alone.
    pub baseline: Option<Baseline>,
    /// The cases, for the script of the page.
    pub cases: CaseTable,
    /// What each feature says about the class by itself, that which says most first.
    pub ranking: Vec<RankedFeature>,
    /// The values of those that say most.
    pub by_class: Vec<FeatureByClass>,
    /// The features of the table.
    pub features: Vec<Feature>,
    /// The values of the features for each fault.
    pub feature_rows: Vec<FeatureRow>,
    /// The columns of all tables.
    pub columns: Vec<Column>,
}

/// Cases and windows of one fault.
#[derive(Clone, Debug)]
pub struct FaultCount {
    /// Label, for instance `big_end+small_end`.
    pub fault: String,
    /// Cases in each split.
    pub cases: Vec<usize>,
    /// Windows in all splits.
    pub windows: usize,
}

/// A parameter that varies over the cases.
#[derive(Clone, Debug)]
pub struct ParameterRange {
    /// What it is: «speed», «clearance of the big end».
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
    /// How many values differ from one another.
    pub distinct: usize,
}

/// A part of one case's recording.
#[derive(Clone, Debug, Default)]
pub struct Response {
    /// The case.
    pub case_id: String,
    /// The file it is in, from the dataset's folder.
    pub file: String,
    /// Crank angle, running on or starting again at every revolution.
    pub crank_angle_rad: Vec<f64>,
    /// Acceleration at these angles.
    pub acceleration_m_s2: Vec<f64>,
    /// Velocity at these angles; empty where the data have none.
    pub velocity_m_s: Vec<f64>,
}

/// An amplitude spectrum of the acceleration.
#[derive(Clone, Debug, Default)]
pub struct Spectrum {
    /// Frequencies in Hz, or orders of the crank's speed.
    pub at: Vec<f64>,
    /// Amplitudes at these.
    pub amplitude_m_s2: Vec<f64>,
    /// Where among them the crank turns: its frequency in Hz, or 1.
    pub fundamental: f64,
}

/// A case that stands for its class.
#[derive(Clone, Debug)]
pub struct ClassExample {
    /// Label of the class.
    pub fault: String,
    /// The sensor that reads it; empty where the dataset has one.
    pub sensor: String,
    /// What sets the case apart: «clearance 0.2 mm, 500 rpm».
    pub operating_point: String,
    /// Its signal.
    pub response: Response,
    /// Amplitude over frequency in Hz, rms over stretches of two revolutions.
    pub spectrum: Spectrum,
    /// Amplitude over order of the crank's speed, rms over the revolutions.
    pub order_spectrum: Spectrum,
}

/// How the cases of the sweep lie.
#[derive(Clone, Debug)]
pub enum Design {
    /// The same clearances in several sets of joints, all else equal.
    Grid(ClearanceGrids),
    /// Drawn at random.
    Random(RandomSweep),
}

/// The grids of a sweep: one for each operating point and each sensor that judges its faults.
#[derive(Clone, Debug, Default)]
pub struct ClearanceGrids {
    /// The grids, in the order of the sweep.
    pub grids: Vec<ClearanceGrid>,
    /// How many more the sweep has.
    pub left_out: usize,
    /// Whether the sweep repeats the clearance study, so that its claims are held against the grids.
    pub claims: bool,
}

/// Responses by set of joints and clearance, as one sensor reads them.
#[derive(Clone, Debug, Default)]
pub struct ClearanceGrid {
    /// What is the same in all cases: «500 rpm, full load».
    pub operating_point: String,
    /// What sets this operating point apart from the others of the sweep: name and value.
    pub settings: Vec<(String, String)>,
    /// The sensor; empty where the dataset has one.
    pub sensor: String,
    /// The machine without clearance, if the sweep has it.
    pub ideal: Option<Response>,
    /// The sets of joints; none where the recordings are not at hand.
    pub joint_sets: Vec<JointSet>,
    /// Frequency above which the motion without clearance has hardly anything.
    pub high_from_hz: f64,
    /// The levels of all cases, the ideal machine first.
    pub levels: Vec<CaseLevel>,
}

/// How large and how violent the acceleration of one case is.
#[derive(Clone, Debug)]
pub struct CaseLevel {
    /// The joints with clearance as a label; `none` for the ideal machine.
    pub joints: String,
    /// Radial clearance in m; 0 for the ideal machine.
    pub clearance_m: f64,
    /// Root mean square, m/s².
    pub rms: Level,
    /// Largest absolute value, m/s².
    pub peak: Level,
    /// Root mean square of what lies above [`ClearanceGrid::high_from_hz`], m/s².
    pub high_rms: Level,
    /// Share of the variance that lies above it.
    pub high_share: f64,
    /// Whether the motion is chaotic by the equations; none where they were not asked.
    pub chaotic: Option<bool>,
}

/// The responses with clearance in the same joints.
#[derive(Clone, Debug)]
pub struct JointSet {
    /// The joints as a label: `big_end+small_end`.
    pub joints: String,
    /// Radial clearance in m, and the response with it.
    pub responses: Vec<(f64, Response)>,
}

/// Parameters and features of cases drawn at random.
#[derive(Clone, Debug)]
pub struct RandomSweep {
    /// How parameters are spread over the cases.
    pub histograms: Vec<Histogram>,
    /// How features go with parameters.
    pub scatters: Vec<Scatter>,
}

/// What goes with speed and load, as far as they vary.
#[derive(Clone, Debug, Default)]
pub struct Operation {
    /// The rms over the speed and over discharge pressures, of each sensor.
    pub trends: Vec<Scatter>,
    /// Spectra over the speed, of each sensor.
    pub waterfalls: Vec<Waterfall>,
}

/// Spectra of one class over the speed, as one sensor reads them.
#[derive(Clone, Debug)]
pub struct Waterfall {
    /// Label of the class.
    pub fault: String,
    /// The sensor; empty where the dataset has one.
    pub sensor: String,
    /// Speed in rad/s, the lowest first, and the order spectrum there.
    pub spectra: Vec<(f64, Spectrum)>,
}

/// The values of one parameter over all cases.
#[derive(Clone, Debug)]
pub struct Histogram {
    /// What it is, as [`ParameterRange::name`].
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// One value per case.
    pub values: Vec<f64>,
}

/// A feature against a parameter, by fault.
#[derive(Clone, Debug)]
pub struct Scatter {
    /// The sensor; empty where the dataset has one.
    pub sensor: String,
    /// Name and unit of the parameter.
    pub x: (String, String),
    /// Name and unit of the feature.
    pub y: (String, String),
    /// True for a logarithmic axis of the feature.
    pub log_y: bool,
    /// Label of a fault, and the points (parameter, feature) with it.
    pub classes: Vec<(String, Vec<[f64; 2]>)>,
}

/// The values of a feature by class.
#[derive(Clone, Debug)]
pub struct FeatureByClass {
    /// Its column.
    pub name: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// The label of each class and the finite values of its windows.
    pub classes: Vec<(String, Vec<f64>)>,
}

impl FeatureByClass {
    /// Whether all values are above zero and the greatest is more than a hundred times the least.
    fn spans_decades(&self) -> bool {
        let values = || self.classes.iter().flat_map(|(_, values)| values).copied();
        let (low, high) = values().fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        low > 0.0 && high > 100.0 * low
    }
}

/// A feature of the table.
#[derive(Clone, Debug)]
pub struct Feature {
    /// Its name.
    pub name: String,
    /// Its unit; empty for none.
    pub unit: String,
}

/// The features of one fault.
#[derive(Clone, Debug)]
pub struct FeatureRow {
    /// Label of the fault.
    pub fault: String,
    /// The sensor, as features are named after it.
    pub sensor: String,
    /// Windows that were averaged.
    pub windows: usize,
    /// Mean and standard deviation of each feature, in the order of [`DatasetPage::features`].
    pub values: Vec<(f64, f64)>,
}

impl DatasetPage {
    /// The colour that a class has in all figures.
    fn class_colour(&self, fault: &str) -> Colour {
        let labels = self.faults.iter().map(|count| count.fault.as_str());
        classes::colour(fault, &self.joints, labels)
    }
}
