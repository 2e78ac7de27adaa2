//! The part of the table that condition monitoring looks at: where the power lies, what comes in
//! impacts, what repeats every revolution, and where in the revolution it is.

use super::line::{Line, MCFADDEN, Unit, Value};
use crate::spectral::{HIGHEST_ENVELOPE_ORDER, PASSED, SECTORS, SEGMENT_S, SHAPE_TO_HZ};

const PEETERS: &str = "Peeters 2004, A large set of audio features, IRCAM, 6.1; spectrum: Welch \
    1967, IEEE Trans. Audio Electroacoustics 15, 70";
const INOUYE: &str = "Inouye et al. 1991, Electroenceph. Clin. Neurophysiol. 79, 204; spectrum: \
    Welch 1967, IEEE Trans. Audio Electroacoustics 15, 70";
const ANTONI: &str = "Antoni 2007, Mechanical Systems and Signal Processing 21, 108; bands cut \
    from one Fourier transform, crate signal, module kurtogram";
const RANDALL: &str = "Randall, Antoni 2011, Mechanical Systems and Signal Processing 25, 485";
const CEPSTRUM: &str = "Randall 2017, Mechanical Systems and Signal Processing 97, 3; over crank \
    angle, magnitudes not below 1e-4 of the largest";
const OWN: &str = "crate signal, module crank_waterfall";
/// The frequencies over which the shape of a spectrum is described.
fn shape_of() -> String {
    format!(
        "up to {SHAPE_TO_HZ} Hz ({PASSED} of the sample rate if that is less), in segments of one \
         revolution ({SEGMENT_S} s where no speed is known)"
    )
}

pub(super) fn lines() -> impl Iterator<Item = Line> {
    let envelope = envelope().into_iter();
    let orders = (1..=HIGHEST_ENVELOPE_ORDER).map(envelope_order);
    let sectors = (0..SECTORS).map(sector);
    let lines = shape().into_iter().chain(envelope).chain(orders);
    lines
        .chain(synchronous())
        .chain(sectors)
        .chain([cepstrum()])
}

fn line(
    name: impl Into<String>,
    unit: Unit,
    description: impl Into<String>,
    formula: &'static str,
    source: &'static str,
    value: Value,
) -> Line {
    Line {
        name: name.into(),
        unit,
        description: description.into(),
        formula,
        source,
        value,
    }
}

fn shape() -> [Line; 3] {
    let of = shape_of();
    [
        line(
            "spectral_centroid",
            Unit::Of("Hz"),
            format!("Mean frequency of the power {of}"),
            "f̄ = Σ f_k p_k, p_k = S_k/ΣS, S the Welch spectrum",
            PEETERS,
            Value::Shape(|s| s.centroid),
        ),
        line(
            "spectral_spread",
            Unit::Of("Hz"),
            format!("Standard deviation over frequency of the power {of}"),
            "√Σ (f_k − f̄)² p_k",
            PEETERS,
            Value::Shape(|s| s.spread),
        ),
        line(
            "spectral_entropy",
            Unit::Pure,
            format!("Entropy over frequency, 0 for a line, 1 for white noise, of the power {of}"),
            "−Σ p_k ln p_k / ln K over K bins",
            INOUYE,
            Value::Shape(|s| s.entropy),
        ),
    ]
}

fn envelope() -> [Line; 3] {
    [
        line(
            "envelope_centre",
            Unit::Of("Hz"),
            "Centre of the most impulsive frequency band, 40 orders wide or wider",
            "f_c of the largest ⟨|c|⁴⟩/⟨|c|²⟩² − 2 over the bands, c the complex envelope",
            ANTONI,
            Value::Envelope(|e| e.centre()),
        ),
        line(
            "envelope_width",
            Unit::Of("Hz"),
            "Width of the most impulsive frequency band, between half amplitudes",
            "B of the largest ⟨|c|⁴⟩/⟨|c|²⟩² − 2 over the bands",
            ANTONI,
            Value::Envelope(|e| e.width()),
        ),
        line(
            "envelope_kurtosis",
            Unit::Pure,
            "Spectral kurtosis of the most impulsive frequency band; 0 for Gaussian noise",
            "max over the bands of ⟨|c|⁴⟩/⟨|c|²⟩² − 2",
            ANTONI,
            Value::Envelope(|e| e.kurtosis()),
        ),
    ]
}

fn envelope_order(k: usize) -> Line {
    line(
        format!("envelope_order_{k}"),
        Unit::OfChannel,
        format!(
            "Amplitude at {k} times the shaft's speed of the envelope in the most impulsive band, \
             of its mean over the whole revolutions"
        ),
        "|(2/N) Σ_j ē(θ_j) e^(−ikθ_j)|, e = |c|",
        RANDALL,
        Value::EnvelopeOrder(k),
    )
}

fn synchronous() -> [Line; 3] {
    [
        line(
            "residual_rms",
            Unit::OfChannel,
            "RMS of what the mean over the revolutions does not hold",
            "√⟨r²⟩, r = x(θ) − x̄(θ mod 2π)",
            MCFADDEN,
            Value::Synchronous(|s| Ok(s.residual_rms())),
        ),
        line(
            "residual_kurtosis",
            Unit::Pure,
            "Kurtosis of what the mean over the revolutions does not hold; 3 if Gaussian",
            "⟨r⁴⟩/⟨r²⟩²",
            MCFADDEN,
            Value::Synchronous(|s| s.residual_kurtosis()),
        ),
        line(
            "synchronous_share",
            Unit::Pure,
            "Share of the mean square about the mean that repeats every revolution; of noise 1/R \
             in R revolutions",
            "1 − ⟨r²⟩/⟨(x − x̄)²⟩",
            MCFADDEN,
            Value::Synchronous(|s| s.synchronous_share()),
        ),
    ]
}

fn sector(index: usize) -> Line {
    let degrees = 360 / SECTORS;
    let [low, high] = [index * degrees, (index + 1) * degrees];
    line(
        format!("sector_{:02}_rms", index + 1),
        Unit::OfChannel,
        format!(
            "RMS at crank angles from {low}° to {high}° after top dead centre, over the whole revolutions"
        ),
        "√⟨x(θ)²⟩ over the sector",
        OWN,
        Value::Sector(index),
    )
}

fn cepstrum() -> Line {
    line(
        "cepstrum_revolution",
        Unit::Pure,
        "Real cepstrum over the crank angle at one revolution; large where lines stand at every \
         order",
        "c_N = (1/n) Σ_k ln|X_k| cos(2πkN/n), N points per revolution, n in all",
        CEPSTRUM,
        Value::Cepstrum,
    )
}
