//! The HTML page of an explanation: where model and recordings disagreed, which effect was missing,
//! and how far the gap has shrunk.

mod figures;
mod page;

use crate::calibration_page::Run;

/// All that the page tells. Numbers are SI; misfits are in units of the recordings' noise, so that 1
/// is noise alone.
#[derive(Clone, Debug, Default)]
pub struct GapPage {
    /// Name of the machine.
    pub name: String,
    /// Version of the program that makes the page.
    pub version: String,
    /// `no-gap`, `explained`, `partly-explained` or `unexplained`.
    pub verdict: String,
    /// Misfit of the runs that were fitted to, of the calibrated machine and with the effects.
    pub gap: [f64; 2],
    /// Root mean square of simulated less recorded pressure, without the effects and with them, Pa;
    /// none where no pressure was recorded.
    pub pressure_rms_pa: Option<[f64; 2]>,
    /// What must be known to judge the results, in sentences.
    pub notes: Vec<String>,
    /// The gap as it shrank, the nominal machine first.
    pub steps: Vec<Step>,
    /// The effects, in the order in which they were added.
    pub effects: Vec<Effect>,
    /// Candidates that were tried and did not earn their place, with their misfit.
    pub refused: Vec<(String, f64)>,
    /// The force on the crossheads that was estimated where the catalogue explains too little.
    pub forces: Vec<Force>,
    /// Where the gap was and is.
    pub maps: Vec<Map>,
    /// How the gap grows from run to run, before an effect was added.
    pub scaling: Vec<Scaling>,
    /// The runs.
    pub runs: Vec<Run>,
    /// What to measure next; empty where nothing is asked for.
    pub next_recording: String,
}

/// A model on the way.
#[derive(Clone, Debug, Default)]
pub struct Step {
    /// What was done last.
    pub label: String,
    /// Misfit of the runs that were fitted to.
    pub fitted: f64,
    /// Misfit of those held out.
    pub held_out: Option<f64>,
}

/// How the residual of a channel grows with the conditions of the runs.
#[derive(Clone, Debug, Default)]
pub struct Scaling {
    /// The channel's column.
    pub channel: String,
    /// The condition, the power of it with which the residual grows, and its standard error.
    pub exponents: Vec<(String, f64, Option<f64>)>,
}

/// A force over a revolution of a run.
#[derive(Clone, Debug, Default)]
pub struct Force {
    /// The run, and the throw where there are several.
    pub label: String,
    /// At equally spaced crank angles from 0 on, N.
    pub force: Vec<f64>,
}

/// An effect that was added.
#[derive(Clone, Debug, Default)]
pub struct Effect {
    /// Its name, with its place.
    pub label: String,
    /// What it is, for a mechanic.
    pub sentence: String,
    /// Its law as a formula, where it has none of its own in the catalogue; empty elsewhere.
    pub expression: String,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// What else might have been, the nearest first.
    pub rivals: Vec<Rival>,
}

/// A candidate that the recordings do not tell from an effect.
#[derive(Clone, Debug, Default)]
pub struct Rival {
    /// Its name, with its place.
    pub label: String,
    /// Misfit that it leaves in place of the effect.
    pub leaves: f64,
    /// Share of what the effect explains that it explains.
    pub explains: f64,
    /// Correlation of what the two change, 0 to 1; none where they were not compared.
    pub correlation: Option<f64>,
}

/// A parameter of an effect.
#[derive(Clone, Debug, Default)]
pub struct Parameter {
    /// Its key.
    pub key: String,
    /// Its unit; empty for a plain number.
    pub unit: String,
    /// Its value.
    pub value: f64,
    /// Its 95 % interval; none where the recordings do not tell it.
    pub interval: Option<[f64; 2]>,
}

/// The residual of a channel of a run over crank angle and orders.
#[derive(Clone, Debug, Default)]
pub struct Map {
    /// The run.
    pub run: String,
    /// The channel's column.
    pub channel: String,
    /// The bands of orders.
    pub bands: Vec<String>,
    /// For each band and sector the residual over the noise, without the effects.
    pub before: Vec<Vec<f64>>,
    /// The same with them.
    pub after: Vec<Vec<f64>>,
}
