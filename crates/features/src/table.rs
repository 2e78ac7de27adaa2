//! The one list of features: names, units and documentation, and where each value comes from.

mod condition;
mod indicator;
mod line;
mod overall;

pub(crate) use line::{Line, Unit, Value};

use crate::reason::Reason;
use crate::spectral::{BAND_EDGES_HZ, HIGHEST_ORDER};
use crate::statistics::Statistics;
use line::MCFADDEN;
use signal::phase_portrait::PhasePortrait;
use std::sync::LazyLock;

/// The features of a channel of this unit, in the order of their columns: statistics of every
/// channel, orders of vibrations and pressures, bands and overall values of vibrations, the p-V card of pressures, all others
/// of accelerations.
pub(crate) fn lines(unit: &str) -> impl Iterator<Item = &'static Line> + use<> {
    let acceleration = unit == "m/s^2";
    let velocity = unit == "m/s";
    let pressure = unit == "Pa";
    TABLE.iter().filter(move |line| match line.value {
        Value::Statistic(_) => true,
        Value::Order(_) | Value::OrderRms(_) => acceleration || velocity || pressure,
        Value::Band(_) | Value::Overall(_) => acceleration || velocity,
        Value::Indicated(_) => pressure,
        _ => acceleration,
    })
}

static TABLE: LazyLock<Vec<Line>> = LazyLock::new(|| {
    let bands = (0..BAND_EDGES_HZ.len() - 1).map(band);
    let orders = (1..=HIGHEST_ORDER).map(order);
    let orders_rms = (1..=HIGHEST_ORDER).map(order_rms);
    let spectra = bands.chain(orders).chain(orders_rms);
    let chained = statistics().into_iter().chain(spectra).chain(portrait());
    // Columns that are added stand last, so that the others keep their places.
    let added = overall::lines().chain(indicator::lines());
    chained.chain(condition::lines()).chain(added).collect()
});

const LEI: &str =
    "Lei, He, Zi 2008, Expert Systems with Applications 35, 1593, with 1/n throughout";
const HARRIS: &str = "Harris 1978, Proc. IEEE 66, 51; Parseval's theorem";
const FYFE: &str = "Fyfe, Munck 1997, Mechanical Systems and Signal Processing 11, 187";
const OWN: &str = "crate signal, module phase_portrait";

fn statistics() -> [Line; 10] {
    use Unit::{OfChannel, Pure};
    let line = |name: &str,
                unit,
                description: &str,
                formula,
                value: fn(&Statistics) -> Result<f64, Reason>| Line {
        name: name.to_owned(),
        unit,
        description: description.to_owned(),
        formula,
        source: LEI,
        value: Value::Statistic(value),
    };
    [
        line("mean", OfChannel, "Mean", "x̄ = Σx/n", |s| Ok(s.mean())),
        line(
            "rms",
            OfChannel,
            "Root mean square, with the mean",
            "√(Σx²/n)",
            |s| Ok(s.rms()),
        ),
        line("peak", OfChannel, "Largest magnitude", "max|x|", |s| {
            Ok(s.peak())
        }),
        line(
            "peak_to_peak",
            OfChannel,
            "From the lowest to the highest sample",
            "max x − min x",
            |s| Ok(s.peak_to_peak()),
        ),
        line(
            "crest_factor",
            Pure,
            "Peak over RMS",
            "max|x| / √(Σx²/n)",
            Statistics::crest_factor,
        ),
        line(
            "shape_factor",
            Pure,
            "RMS over mean magnitude",
            "√(Σx²/n) / (Σ|x|/n)",
            Statistics::shape_factor,
        ),
        line(
            "impulse_factor",
            Pure,
            "Peak over mean magnitude",
            "max|x| / (Σ|x|/n)",
            Statistics::impulse_factor,
        ),
        line(
            "clearance_factor",
            Pure,
            "Peak over the squared mean of the roots of the magnitudes",
            "max|x| / (Σ√|x|/n)²",
            Statistics::clearance_factor,
        ),
        line(
            "skewness",
            Pure,
            "Third central moment over the variance to the power 3/2; 0 if symmetric",
            "(Σ(x−x̄)³/n) / (Σ(x−x̄)²/n)^(3/2)",
            Statistics::skewness,
        ),
        line(
            "kurtosis",
            Pure,
            "Fourth central moment over the squared variance (not excess); 3 if Gaussian",
            "(Σ(x−x̄)⁴/n) / (Σ(x−x̄)²/n)²",
            Statistics::kurtosis,
        ),
    ]
}

fn band(index: usize) -> Line {
    let [low, high] = [BAND_EDGES_HZ[index], BAND_EDGES_HZ[index + 1]];
    let (name, range) = if high.is_finite() {
        (
            format!("band_{low:04}_{high:04}"),
            format!("{low} to {high} Hz"),
        )
    } else {
        (
            format!("band_{low:04}_up"),
            format!("{low} Hz to half the sample rate"),
        )
    };
    Line {
        name,
        unit: Unit::SquareOfChannel,
        description: format!(
            "Mean square about the mean from {range}, Hann window; all bands add up to the variance"
        ),
        formula: "(Σ(x−x̄)²/n) · Σ_band|X_k|² / Σ|X_k|²",
        source: HARRIS,
        value: Value::Band(index),
    }
}

fn order(k: usize) -> Line {
    Line {
        name: format!("order_{k:02}"),
        unit: Unit::OfChannel,
        description: format!(
            "Amplitude at {k} times the shaft's speed, of the mean over the whole revolutions"
        ),
        formula: "|(2/N) Σ_j x̄(θ_j) e^(−ikθ_j)|",
        source: MCFADDEN,
        value: Value::Order(k),
    }
}

fn order_rms(k: usize) -> Line {
    Line {
        name: format!("order_{k:02}_rms"),
        unit: Unit::OfChannel,
        description: format!(
            "RMS over the whole revolutions of their amplitudes at {k} times the shaft's speed"
        ),
        formula: "√⟨|(2/N) Σ_j x_r(θ_j) e^(−ikθ_j)|²⟩ over revolutions r",
        source: FYFE,
        value: Value::OrderRms(k),
    }
}

fn portrait() -> [Line; 4] {
    let line = |name: &str,
                unit,
                description: &str,
                formula,
                value: fn(&PhasePortrait) -> Result<f64, signal::Error>| Line {
        name: format!("portrait_{name}"),
        unit,
        description: description.to_owned(),
        formula,
        source: OWN,
        value: Value::Portrait(value),
    };
    [
        line(
            "area",
            Unit::Of("m^2/s^3"),
            "Area that a revolution encloses in the plane of velocity and acceleration",
            "½ ∮ (a dv − v da), mean over revolutions",
            |p| Ok(p.area()),
        ),
        line(
            "velocity_extent",
            Unit::Of("m/s"),
            "Velocity of a revolution, peak to peak",
            "max v − min v, mean over revolutions",
            |p| Ok(p.velocity_extent()),
        ),
        line(
            "acceleration_extent",
            Unit::OfChannel,
            "Acceleration of a revolution, peak to peak",
            "max a − min a, mean over revolutions",
            |p| Ok(p.acceleration_extent()),
        ),
        line(
            "scatter",
            Unit::Pure,
            "RMS distance of the revolutions from the mean loop over its RMS radius; 0 if periodic",
            "√(½ (⟨(v−v̄)²⟩/⟨v̄²⟩ + ⟨(a−ā)²⟩/⟨ā²⟩))",
            PhasePortrait::scatter,
        ),
    ]
}
