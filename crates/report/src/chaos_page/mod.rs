//! The HTML page of what a sweep says about chaos.
//!
//! [`ChaosPage::from_dataset`] reads the tables of the dataset and simulates the few cases whose
//! motion is shown again. [`ChaosPage::render`] is one file with its styles and figures inside. A
//! section without data says what to add to the sweep file. The size is bounded for any dataset.

mod agreement;
mod bifurcations;
mod claims;
mod exponents;
mod levels;
mod maps;
mod motions;
mod page;
mod regime;
mod spectra;
mod table;

pub use regime::Regime;
pub(crate) use spectra::MOST_CLASSES;

use crate::classes;
use crate::figure::Colour;

/// The content of the page. Numbers are SI, speeds in rpm; labels are as in the data.
#[derive(Clone, Debug, Default)]
pub struct ChaosPage {
    /// Name of the dataset.
    pub name: String,
    /// Version of the program that wrote it.
    pub version: String,
    /// Seed of the sweep.
    pub seed: u64,
    /// The machine's joints, in their order.
    pub joints: Vec<String>,
    /// Whether the sweep repeats the clearance study, so that its claims are held against the cases.
    pub claims: bool,
    /// The cases whose motion is shown, in rows.
    pub motions: Vec<MotionRow>,
    /// Which cases these are, as a rule.
    pub shown: String,
    /// Bifurcation diagrams.
    pub bifurcations: Vec<Bifurcation>,
    /// Exponents and regimes of all cases.
    pub cases: Vec<CaseChaos>,
    /// Spectra of each class.
    pub spectra: Vec<ClassSpectra>,
    /// How many windows of a class its spectra are from at most.
    pub most_windows: usize,
}

/// Motions that stand in one row of every figure.
#[derive(Clone, Debug)]
pub struct MotionRow {
    /// What they have in common: the joints with clearance.
    pub heading: String,
    /// The motions, left to right; none where the sweep lacks the case.
    pub motions: Vec<Option<Motion>>,
}

/// The motion of one case, as no sensor sees it.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// What sets it apart from the others of its row: its clearance.
    pub title: String,
    /// The case.
    pub case_id: String,
    /// Crank angle, starting again at every revolution.
    pub crank_angle_rad: Vec<f64>,
    /// Velocity of the crosshead at these angles.
    pub velocity_m_s: Vec<f64>,
    /// Its acceleration.
    pub acceleration_m_s2: Vec<f64>,
    /// The joints with clearance.
    pub joints: Vec<Orbit>,
    /// Velocity and acceleration of the crosshead once a revolution, at crank angle 0.
    pub strobe: Vec<[f64; 2]>,
}

/// The motion in one joint.
#[derive(Clone, Debug, Default)]
pub struct Orbit {
    /// Name in the data, for instance `big_end`.
    pub name: String,
    /// Radial clearance.
    pub clearance_m: f64,
    /// The journal's centre from the bearing's.
    pub x_m: Vec<f64>,
    /// The same across `x_m`.
    pub y_m: Vec<f64>,
    /// Where the journal meets the bearing: crank angle in rad and speed of approach in m/s.
    pub impacts: Vec<[f64; 2]>,
}

/// How the motion changes along a path of the machine file.
#[derive(Clone, Debug, Default)]
pub struct Bifurcation {
    /// Its name in the sweep file.
    pub name: String,
    /// What varies, in words.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// What is recorded once a revolution.
    pub quantities: Vec<Recorded>,
    /// The motion at each value, once a revolution; empty where its velocity is not recorded.
    pub sections: Vec<Section>,
    /// Why values have no points, each reason once.
    pub reasons: Vec<String>,
}

/// The motion at a value of the parameter of a bifurcation diagram, when the crank passes angle 0.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct Section {
    /// The value.
    pub value: f64,
    /// Velocity in m/s and acceleration in m/s² of each revolution, the parameter rising.
    pub up: Vec<[f64; 2]>,
    /// The same with the parameter falling.
    pub down: Vec<[f64; 2]>,
}

/// One quantity of a bifurcation diagram.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    /// What it is.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// (parameter, quantity) of each revolution, the parameter rising from run to run.
    pub up: Vec<[f64; 2]>,
    /// The same with the parameter falling.
    pub down: Vec<[f64; 2]>,
}

/// What is known about the chaos of one case.
#[derive(Clone, Debug, Default)]
pub struct CaseChaos {
    /// The case.
    pub case_id: String,
    /// The joints with clearance as a label; `none` for the ideal machine.
    pub joints: String,
    /// The largest of their clearances.
    pub clearance_m: f64,
    /// Speed of the crank.
    pub speed_rpm: f64,
    /// The same number for cases that differ in their clearances alone.
    pub operating_point: usize,
    /// Largest Lyapunov exponent from the equations and its standard error, 1/s.
    pub exponent: Option<[f64; 2]>,
    /// Regime from the equations.
    pub regime: Option<Regime>,
    /// What the signal of each window says.
    pub windows: Vec<WindowChaos>,
}

/// What the signal of one window says.
#[derive(Clone, Debug, Default)]
pub struct WindowChaos {
    /// Largest Lyapunov exponent with the ends of its 95 % interval, 1/s: value, low, high.
    pub exponent: Option<[f64; 3]>,
    /// Why there is no exponent; empty if there is one, or if it was not computed.
    pub reason: String,
    /// Regime from the signal.
    pub regime: Option<Regime>,
}

/// Spectra of the windows of one class.
#[derive(Clone, Debug, Default)]
pub struct ClassSpectra {
    /// The joints with clearance as a label.
    pub class: String,
    /// Windows that the spectra are from.
    pub windows: usize,
    /// Amplitude density of the acceleration, m/s²/√Hz, over frequency in Hz.
    pub spectrum: Quartiles,
    /// Amplitude of the envelope's spectrum, m/s², over order of the crank's speed.
    pub envelope: Quartiles,
}

/// The middle half of several curves.
#[derive(Clone, Debug, Default)]
pub struct Quartiles {
    /// Where.
    pub at: Vec<f64>,
    /// Lower quartile, median and upper quartile there.
    pub values: Vec<[f64; 3]>,
}

impl Quartiles {
    /// Of curves over the places `at`, each as long; places without a finite value are left out.
    pub fn from_curves(at: &[f64], curves: &[Vec<f64>]) -> Self {
        let mut quartiles = Self::default();
        for (i, &place) in at.iter().enumerate() {
            let here: Vec<f64> = curves
                .iter()
                .filter_map(|curve| curve.get(i).copied())
                .collect();
            let three = [0.25, 0.5, 0.75].map(|part| crate::statistics::quantile(&here, part));
            if let [Some(low), Some(middle), Some(high)] = three {
                quartiles.at.push(place);
                quartiles.values.push([low, middle, high]);
            }
        }
        quartiles
    }
}

impl ChaosPage {
    /// The colour that a class has on all pages of the dataset.
    fn class_colour(&self, label: &str) -> Colour {
        let of_cases = self.cases.iter().map(|case| case.joints.as_str());
        let labels = self.spectra.iter().map(|class| class.class.as_str());
        classes::colour(label, &self.joints, labels.chain(of_cases))
    }
}
