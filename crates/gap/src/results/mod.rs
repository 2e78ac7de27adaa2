//! What an explanation finds: the content of `gap.json`.
//!
//! Values are SI, misfits are in standard deviations of the noise: 1 is noise alone. The same inputs give
//! the same bytes.

pub(crate) mod expression;
pub(crate) mod form;
pub(crate) mod next_recording;
pub(crate) mod notes;
pub mod parts;
pub mod residual_map;
pub mod scaling;
pub(crate) mod summary;

use crate::amendment::candidate::Candidate;
use crate::criteria::{Evidence, Verdict};
use crate::error::Error;
use crate::explain::Explanation;
use crate::finding::{Correction, Found, Tried, first_item};
use crate::fitter::effort::Effort;
use crate::force::missing_force::MissingForce;
use crate::model::Model;
use crate::recorded::Recorded;
use crate::results::expression::expression;
use crate::results::form::form;
use crate::results::notes::{closing, notes};
use crate::results::parts::ByPart;
use crate::results::residual_map::{Place, ResidualMap, band_names, places, residual_maps};
use crate::results::scaling::{Scaling, scaling};
use crate::steps::{Step, StepModel};
use calibrate::ShutValve;
use calibrate::fit;
use calibrate::pressure_gap::PressureGap;
use calibrate::recorded_sensor::RecordedSensor;
use calibrate::results::{ByName, Estimate};
use input::effects::{Proposal, entry};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the file of results.
pub const RESULTS: &str = "gap.json";
/// Most places in which the gap is reported.
const PLACES: usize = 40;

/// What an explanation finds.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Results {
    /// What it comes to.
    pub verdict: Verdict,
    /// The effects, in the order in which they were added, then those of the measuring chain.
    pub effects: Vec<Effect>,
    /// Values of the data sheet that turned out wrong.
    pub corrections: Vec<Correction>,
    /// The misfits over the runs.
    pub gap: Misfits,
    /// The gap as it shrank, the nominal machine first.
    pub steps: Vec<Step>,
    /// What must be known to judge the results, in sentences.
    pub notes: Vec<String>,
    /// The valves that recorded pressures do not open.
    #[serde(default)]
    pub shut_valves: Vec<ShutValve>,
    /// What was fitted, by path, the parameters of effects included.
    pub parameters: ByName<Estimate>,
    /// What each run and channel says of the effects by itself; none where nothing was tried.
    #[serde(default)]
    pub by_part: Option<ByPart>,
    /// Where the calibrated machine without the effects and the recordings disagree most, the greatest
    /// excess first.
    #[serde(rename = "where")]
    pub places: Vec<Place>,
    /// How its residual grows with the conditions of the runs.
    pub scaling: Vec<Scaling>,
    /// The runs that were held out.
    pub heldout_runs: Vec<String>,
    /// What to measure to distinguish effects from their rivals; `None` where nothing is needed.
    pub next_recording: Option<String>,
    /// The force that is missing where the catalogue explains too little; empty elsewhere.
    pub missing_force: Vec<MissingForce>,
    /// What was tried last and did not earn its place.
    pub refused: Vec<Other>,
    /// The measuring chains that the recordings show, by column.
    pub noise: BTreeMap<String, RecordedSensor>,
    /// What it cost, in steps of the integrator for each throw.
    pub cost: u64,
    /// Always none: the time that it took is this computer's.
    pub seconds: Option<f64>,
    /// The runs.
    pub runs: ByName<Run>,
    /// The residuals over crank angle and orders.
    pub maps: Maps,
}

/// An effect that was added, at one place.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Effect {
    /// Its name in the catalogue.
    pub effect: String,
    /// Its name, with its place.
    pub label: String,
    /// The throw at which it acts, where it does at one alone.
    pub throw: Option<String>,
    /// Its joint, where it has one.
    pub joint: Option<String>,
    /// The end of the cylinder at which it acts, where it does at one alone.
    pub end: Option<String>,
    /// What it is, for a mechanic.
    pub sentence: String,
    /// Its parameters, SI, by their keys.
    pub parameters: ByName<Bounded>,
    /// Its law as a formula, where it has no name in the catalogue.
    pub expression: Option<String>,
    /// Probability that it is what is there, 0 to 1.
    pub probability: f64,
    /// Everywhere that it acts: joints, ends, throws, sensors.
    pub places: Vec<String>,
    /// What is known of the shape of its law; none where that is not identifiable.
    pub form: Option<String>,
    /// On what it was decided.
    pub evidence: Evidence,
    /// Root mean square of simulated less recorded pressure that it leaves in each run, Pa.
    pub pressure_rms_pa: ByName<f64>,
    /// What else might have been, the nearest first.
    pub rivals: Vec<Other>,
}

/// A value, SI.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounded {
    /// The value.
    pub value: f64,
    /// The lower end of its 95 % interval, where it has one; the value itself where it was not searched.
    pub low: Option<f64>,
    /// The upper end.
    pub high: Option<f64>,
}

impl Effect {
    /// Its parameters with their SI units; not those of the form of its law that are as usual.
    pub fn stated(&self) -> impl Iterator<Item = (&str, &'static str, &Bounded)> {
        let entry = entry(&self.effect);
        self.parameters.iter().filter_map(move |(key, bounded)| {
            let parameter = entry.and_then(|entry| entry.parameter(key));
            let usual = parameter.is_some_and(|p| p.shape)
                && bounded.interval() == Some([bounded.value; 2]);
            (!usual).then(|| (key, parameter.map_or("", |p| p.unit), bounded))
        })
    }
}

/// A candidate that was not added.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Other {
    /// Its name in the catalogue.
    pub effect: String,
    /// The throw at which it acts, where it does at one alone.
    pub throw: Option<String>,
    /// Its joint, where it has one.
    pub joint: Option<String>,
    /// The end of the cylinder at which it acts, where it does at one alone.
    pub end: Option<String>,
    /// Its name, with its place.
    pub label: String,
    /// How well it did.
    pub evidence: Evidence,
    /// Probability that it is what is there, 0 to 1.
    pub probability: f64,
    /// Misfit that it leaves.
    pub leaves: f64,
}

/// Misfits: of the nominal machine, and without (`before`) and with (`after`) the effects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Misfits {
    /// What they are in.
    pub unit: String,
    /// What noise alone leaves.
    pub noise_floor: f64,
    /// Of the fitted runs with the nominal machine.
    pub nominal: f64,
    /// Of the held-out runs with it; none without one.
    pub heldout_nominal: Option<f64>,
    /// Of the fitted runs with the calibrated machine.
    pub before: f64,
    /// Of the fitted runs with the effects.
    pub after: f64,
    /// Of the held-out runs with the calibrated machine.
    pub heldout_before: Option<f64>,
    /// Of the held-out runs with the effects.
    pub heldout_after: Option<f64>,
    /// Root mean square of simulated less recorded pressure over all channels.
    pub pressure_rms_pa: PressureRms,
}

/// Root mean squares of simulated less recorded pressure, Pa; none where no pressure was recorded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PressureRms {
    /// Without the effects.
    pub before: Option<f64>,
    /// With them.
    pub after: Option<f64>,
}

/// A run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// True where it was predicted and not fitted to.
    pub held_out: bool,
    /// Its misfit without the effects.
    pub before: f64,
    /// The same with them.
    pub after: f64,
    /// How far its pressures are off.
    pub pressure_rms_pa: PressureRms,
}

/// The residuals of every channel of every run over crank angle and orders.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Maps {
    /// The bands of orders, in words.
    pub bands: Vec<String>,
    /// Without the effects.
    pub before: Vec<ResidualMap>,
    /// With them.
    pub after: Vec<ResidualMap>,
    /// Of each of [`Results::steps`].
    #[serde(default)]
    pub steps: Vec<Vec<ResidualMap>>,
}

impl Results {
    /// The results of an explanation, with what the recordings show by themselves.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn from_explanation(
        explanation: &Explanation,
        effort: &Effort,
        recorded: &Recorded,
    ) -> Result<Self, Error> {
        let gas = recorded.gas;
        let (before, after) = (&explanation.baseline, &explanation.explained);
        let nominal = &explanation.nominal;
        let maps = Maps {
            bands: band_names(),
            before: residual_maps(before)?,
            after: residual_maps(after)?,
            steps: explanation
                .steps
                .iter()
                .map(|step| residual_maps(&step.model))
                .collect::<Result<_, _>>()?,
        };
        let estimates = explanation.estimates.iter();
        let runs = after.problem.runs.iter().enumerate();
        let run = |(i, run): (usize, &calibrate::Observation)| {
            let content = Run {
                held_out: effort.held_out.contains(&run.id),
                before: before.by_run[i],
                after: after.by_run[i],
                pressure_rms_pa: PressureRms::from_gaps(gas.iter().filter(|gap| gap.run == run.id)),
            };
            (run.id.clone(), content)
        };
        Ok(Self {
            verdict: explanation.verdict,
            effects: effects(explanation)?,
            corrections: explanation.corrections.clone(),
            gap: Misfits {
                unit: "standard deviations of the noise".to_owned(),
                noise_floor: 1.0,
                nominal: nominal.fitted,
                heldout_nominal: nominal.held_out,
                before: before.fitted,
                after: after.fitted,
                heldout_before: before.held_out,
                heldout_after: after.held_out,
                pressure_rms_pa: PressureRms::from_gaps(gas.iter()),
            },
            steps: explanation.steps.iter().map(StepModel::step).collect(),
            notes: notes(explanation, effort, recorded),
            shut_valves: recorded.shut_valves.to_vec(),
            parameters: estimates
                .map(|e| (e.parameter.path.clone(), Estimate::from_fit(e, true)))
                .collect(),
            by_part: ByPart::from_explanation(explanation, &effort.held_out)?,
            places: places(&maps.before, PLACES),
            scaling: scaling(before, &maps.before)?,
            heldout_runs: effort.held_out.clone(),
            next_recording: explanation.next_recording.clone(),
            missing_force: explanation.missing_force.clone(),
            refused: explanation.refused.iter().map(Other::from_tried).collect(),
            noise: recorded.noise.clone(),
            cost: effort.journal.spent(),
            seconds: None,
            runs: runs.map(run).collect(),
            maps,
        })
    }

    /// Reads a file of results.
    ///
    /// # Errors
    /// A file that cannot be read, or that no explanation has written.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let wrong = |reason: String| Error::Input(calibrate::Error::file(path, reason));
        let text = files::read_text(path, files::LONGEST_TEXT)
            .map_err(|error| wrong(error.to_string()))?;
        serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))
    }
}

impl PressureRms {
    fn from_gaps<'a>(gaps: impl Iterator<Item = &'a PressureGap> + Clone) -> Self {
        let rms = |which: usize| {
            let squares = gaps.clone().map(|gap| gap.rms()[which].powi(2));
            let count = gaps.clone().count();
            (count > 0).then(|| (squares.sum::<f64>() / count as f64).sqrt())
        };
        Self {
            before: rms(0),
            after: rms(1),
        }
    }

    /// Both, where pressures were recorded.
    pub fn both(&self) -> Option<[f64; 2]> {
        Some([self.before?, self.after?])
    }
}

impl Bounded {
    /// Its 95 % interval, where it has one.
    pub fn interval(&self) -> Option<[f64; 2]> {
        Some([self.low?, self.high?])
    }
}

impl Other {
    fn from_tried(tried: &Tried) -> Self {
        let candidate = &tried.candidate;
        let place = |place: Option<&str>| place.map(str::to_owned);
        Self {
            effect: candidate.entry.name.to_owned(),
            throw: place(candidate.throw()),
            joint: place(candidate.joint()),
            end: place(candidate.end()),
            label: candidate.label(),
            evidence: tried.evidence.clone(),
            probability: tried.probability,
            leaves: tried.evidence.misfit[1],
        }
    }
}

/// The effects, each once for each item of the machine file's list; those of the measuring chain last.
fn effects(explanation: &Explanation) -> Result<Vec<Effect>, Error> {
    let found = &explanation.found;
    let mut effects = Vec::new();
    for (i, one) in found.iter().enumerate() {
        let first = first_item(&explanation.baseline.problem, found, i);
        effects.extend(of_items(one, Some(first), &explanation.estimates)?);
    }
    for one in &explanation.chain {
        effects.extend(of_items(one, None, &[])?);
    }
    Ok(effects)
}

/// An effect, once for each of its items; `first` is the index of the first one in the machine file's
/// list.
fn of_items(
    found: &Found,
    first: Option<usize>,
    estimates: &[fit::Estimate],
) -> Result<Vec<Effect>, Error> {
    let pressures = found.effect.model.as_ref().map(Model::pressure_rms);
    let pressures = pressures.transpose()?.unwrap_or_default();
    let items = found.candidate().items().into_iter().enumerate();
    let effect = |(i, (item, value)): (usize, (Candidate, usize))| {
        let own = if found.candidate().shared { 0 } else { i };
        let index = first.map(|first| first + own);
        let values = &found.effect.values[value..];
        let parameters = parameters(&item, index, values, estimates);
        let closes = parameters
            .iter()
            .filter_map(|(key, p)| closing(&item, key, p.value));
        let is_law = item.entry.proposal == Proposal::ForceLaw;
        let terms = || parameters.iter().map(|(key, p)| (*key, p.value));
        let place = |place: Option<&str>| place.map(str::to_owned);
        let rivals = found.rivals.iter();
        Effect {
            effect: item.entry.name.to_owned(),
            label: item.label(),
            throw: place(item.throw()),
            joint: place(item.joint()),
            end: place(item.end()),
            sentence: std::iter::once(item.entry.sentence.to_owned())
                .chain(closes)
                .collect(),
            expression: is_law.then(|| expression(terms())),
            probability: found.effect.probability,
            places: found.candidate().places(),
            form: form(&item, |key| known(&parameters, key)),
            evidence: found.effect.evidence.clone(),
            pressure_rms_pa: pressures.iter().cloned().collect(),
            rivals: rivals.map(Other::from_tried).collect(),
            parameters: parameters
                .iter()
                .map(|(key, p)| ((*key).to_owned(), *p))
                .collect(),
        }
    };
    Ok(items.map(effect).collect())
}

/// The value and the interval of the parameter of this key, where it has one.
fn known(parameters: &[(&str, Bounded)], key: &str) -> Option<(f64, [f64; 2])> {
    let (_, bounded) = parameters.iter().find(|(own, _)| *own == key)?;
    Some((bounded.value, [bounded.low?, bounded.high?]))
}

/// The parameters of an item that has this index in the machine file's list, with what is known of them.
fn parameters(
    item: &Candidate,
    index: Option<usize>,
    values: &[f64],
    estimates: &[fit::Estimate],
) -> Vec<(&'static str, Bounded)> {
    let entry = item.entry;
    let all = entry.parameters.iter().zip(values).enumerate();
    // Not the terms that a law does not have.
    let there = all.filter(|(i, (parameter, _))| {
        parameter.absent.is_none() || item.free().any(|free| free == *i)
    });
    let bounded = |(_, (parameter, value)): (usize, (&input::effects::Parameter, &f64))| {
        let path = index.map(|index| format!("effects.{index}.{}.{}", entry.name, parameter.key));
        let estimate = estimates
            .iter()
            .find(|e| Some(&e.parameter.path) == path.as_ref());
        let bounded = match estimate {
            Some(estimate) => Bounded {
                value: estimate.value,
                low: estimate.interval.map(|[low, _]| low),
                high: estimate.interval.map(|[_, high]| high),
            },
            // An order is not searched but tried.
            None => Bounded {
                value: *value,
                low: Some(*value),
                high: Some(*value),
            },
        };
        (parameter.key, bounded)
    };
    there.map(bounded).collect()
}
