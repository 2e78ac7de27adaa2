//! What a fitted machine shows in a run, with the uncertainty that its parameters leave.

use crate::bounded::Bounded;
use crate::error::Error;
use crate::normal::QUANTILE;
use crate::observation::{Observed, POINTS};
use crate::prediction::{Prediction, predict, predict_with_derivatives};
use crate::relation::Relation;
use crate::transfer::case::Case;
use crate::transfer::refit::Fitted;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};
use signal::Complex64;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// What a machine shows in a run under a relation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Forecast {
    /// The run whose speed and pressures hold.
    pub run: String,
    /// The clearances that are not the fitted ones, by the joint's path, m.
    pub clearance_m: BTreeMap<String, f64>,
    /// The relation.
    pub relation: Relation,
    /// Whether the run was recorded at these clearances.
    pub recorded: bool,
    /// Misfit to the recording, in standard deviations of its noise; none without one.
    pub misfit: Option<f64>,
    /// Why the run cannot be simulated; it has no channels then.
    pub failure: Option<String>,
    /// The channels by their columns.
    pub channels: BTreeMap<String, ChannelForecast>,
}

/// What a channel shows: its crank-angle synchronous mean, an acceleration without its constant
/// part, which is its sensor's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelForecast {
    /// Root mean square over a revolution, SI.
    pub rms: Bounded,
    /// Greatest magnitude over a revolution, SI.
    pub peak: Bounded,
    /// The same two of the recording; none without one.
    pub recorded: Option<[f64; 2]>,
    /// Root mean square of the difference to the recording, over that of the recording.
    pub difference: Option<f64>,
}

pub(crate) fn forecast(case: &Case, machine: &Fitted) -> Forecast {
    let (channels, failure) = match channels(case, machine) {
        Ok(channels) => (channels, None),
        Err(error) => (BTreeMap::new(), Some(error.to_string())),
    };
    Forecast {
        run: case.run.id.clone(),
        clearance_m: case.clearances.clone(),
        relation: machine.relation,
        recorded: case.recorded,
        misfit: None,
        failure,
        channels,
    }
}

fn channels(case: &Case, machine: &Fitted) -> Result<BTreeMap<String, ChannelForecast>, Error> {
    let prediction = predict_with_derivatives(&machine.problem, &case.run, &machine.x)?;
    let gradients = gradients(case, machine, &prediction)?;
    let mut channels = BTreeMap::new();
    for (i, observed) in case.run.channels.iter().enumerate() {
        let lines = counted(observed, &prediction.lines[i].amplitude);
        let measured = &observed.lines.amplitude;
        let measured = case.recorded.then(|| counted(observed, measured));
        let shown = Shown::new(&lines);
        let bounded = |value: f64, which: usize| {
            let gradient = DVector::from_iterator(
                machine.x.len(),
                gradients.iter().map(|of_parameter| of_parameter[i][which]),
            );
            let variance = gradient.dot(&(&machine.covariance * &gradient));
            let reach = QUANTILE * variance.max(0.0).sqrt();
            Bounded {
                value,
                low: value - reach,
                high: value + reach,
            }
        };
        channels.insert(
            observed.column.clone(),
            ChannelForecast {
                rms: bounded(shown.rms, 0),
                peak: bounded(shown.peak.abs(), 1),
                recorded: measured.as_ref().map(|measured| {
                    let shown = Shown::new(measured);
                    [shown.rms, shown.peak.abs()]
                }),
                difference: measured.as_ref().map(|measured| {
                    let apart = lines.iter().zip(measured).map(|(a, b)| a - b);
                    rms(apart) / rms(measured.iter().copied())
                }),
            },
        );
    }
    Ok(channels)
}

/// The lines that the recording could show, without the mean of an acceleration.
fn counted(observed: &Observed, amplitude: &[Complex64]) -> Vec<Complex64> {
    let within = amplitude.iter().take(observed.lines.amplitude.len());
    let mut lines: Vec<Complex64> = within.copied().collect();
    if !observed.quantity().has_mean()
        && let Some(mean) = lines.first_mut()
    {
        *mean = Complex64::default();
    }
    lines
}

/// For each parameter and channel the derivatives of RMS and peak by its coordinate. They are exact where the
/// motion repeats itself, and differences over one standard deviation to either side elsewhere.
fn gradients(
    case: &Case,
    machine: &Fitted,
    prediction: &Prediction,
) -> Result<Vec<Vec<[f64; 2]>>, Error> {
    let channels = &case.run.channels;
    if prediction.derivatives.len() == machine.x.len() {
        let of_channel = |derivative: &[Complex64], i: usize| {
            let shown = counted(&channels[i], &prediction.lines[i].amplitude);
            Shown::new(&shown).derivatives(&shown, &counted(&channels[i], derivative))
        };
        let by_parameter = prediction.derivatives.iter();
        return Ok(by_parameter
            .map(|d| (0..channels.len()).map(|i| of_channel(&d[i], i)).collect())
            .collect());
    }
    (0..machine.x.len())
        .map(|parameter| {
            let step = machine.covariance[(parameter, parameter)].sqrt();
            if step == 0.0 {
                return Ok(vec![[0.0; 2]; channels.len()]);
            }
            let shown = |sign: f64| -> Result<Vec<Shown>, Error> {
                let mut x = machine.x.clone();
                x[parameter] += sign * step;
                let prediction = predict(&machine.problem, &case.run, &x)?;
                let all = channels.iter().zip(&prediction.lines);
                Ok(all
                    .map(|(c, l)| Shown::new(&counted(c, &l.amplitude)))
                    .collect())
            };
            let (below, above) = (shown(-1.0)?, shown(1.0)?);
            let slope = |a: f64, b: f64| (b - a) / (2.0 * step);
            let pairs = below.iter().zip(&above);
            Ok(pairs
                .map(|(a, b)| [slope(a.rms, b.rms), slope(a.peak.abs(), b.peak.abs())])
                .collect())
        })
        .collect()
}

/// What a synchronous mean shows.
struct Shown {
    rms: f64,
    /// Its value of greatest magnitude, with its sign.
    peak: f64,
    /// Where that is, rad.
    angle: f64,
}

impl Shown {
    fn new(lines: &[Complex64]) -> Self {
        let angles = (0..POINTS).map(|i| i as f64 * TAU / POINTS as f64);
        let values = angles.map(|angle| (value(lines, angle), angle));
        let greatest = values.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        let (peak, angle) = greatest.unwrap_or((0.0, 0.0));
        Self {
            rms: rms(lines.iter().copied()),
            peak,
            angle,
        }
    }

    /// The derivatives of RMS and peak where the lines have the derivatives `by`. The peak's place
    /// moves too, which to first order does not matter.
    fn derivatives(&self, lines: &[Complex64], by: &[Complex64]) -> [f64; 2] {
        let product = |(k, (c, d)): (usize, (&Complex64, &Complex64))| {
            weight(k) * (c.re * d.re + c.im * d.im)
        };
        let products = lines.iter().zip(by).enumerate().map(product);
        let of_rms = products.sum::<f64>() / self.rms.max(f64::MIN_POSITIVE);
        [of_rms, self.peak.signum() * value(by, self.angle)]
    }
}

/// The synchronous mean with these lines at an angle.
fn value(lines: &[Complex64], angle: f64) -> f64 {
    let turn = Complex64::cis(angle);
    let mut phase = Complex64::new(1.0, 0.0);
    let mut sum = 0.0;
    for line in lines {
        sum += (line * phase).re;
        phase *= turn;
    }
    sum
}

/// Share of a line's squared magnitude in the mean square.
fn weight(order: usize) -> f64 {
    if order == 0 { 1.0 } else { 0.5 }
}

fn rms(lines: impl Iterator<Item = Complex64>) -> f64 {
    let squares = lines.enumerate().map(|(k, c)| weight(k) * c.norm_sqr());
    squares.sum::<f64>().sqrt()
}
