//! What is in no catalogue: the workflow must not take it for something that is.

use serde::{Deserialize, Serialize};
use simulate::{Measured, Record, Sensor};

/// Corner of the recorder's coupling, over the frequency of the crank.
const CORNER: f64 = 0.4;
/// By how much the channel of an acceleration is late, s.
const LAG: f64 = 3e-4;

/// Something that the model cannot have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outside {
    /// Contacts of another law: Flores, Machado, Silva and Martins 2011 in place of IMPACT.
    ContactLaw,
    /// Accelerations behind a capacitor: a high pass of the first order, which lowers and turns the
    /// first orders.
    AcCoupling,
    /// Accelerations that come later than the crank angle that is recorded with them.
    TimeLag,
    /// A mass, a length or an inertia that the data sheet has wrong: a correction, and no effect.
    DataSheet,
}

impl Outside {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::ContactLaw,
        Self::AcCoupling,
        Self::TimeLag,
        Self::DataSheet,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::ContactLaw => "contact_law",
            Self::AcCoupling => "ac_coupling",
            Self::TimeLag => "time_lag",
            Self::DataSheet => "data_sheet",
        }
    }

    /// Changes what `sensors` have recorded of a crank that turns at `speed`, rad/s.
    pub fn change(self, record: &mut Record, sensors: &[Sensor], rate: f64, speed: f64) {
        let series = sensors.iter().zip(&mut record.series);
        let accelerations = series.filter(|(sensor, _)| {
            matches!(sensor.measured, Measured::CrossheadAcceleration { .. })
        });
        for (_, samples) in accelerations {
            match self {
                Self::ContactLaw | Self::DataSheet => {}
                Self::AcCoupling => high_pass(samples, CORNER * speed / rate),
                Self::TimeLag => lag(samples, LAG * rate),
            }
        }
    }
}

/// A high pass of the first order by the bilinear transform, its corner in rad per sample, at rest with
/// the mean of the samples.
fn high_pass(samples: &mut [f64], corner: f64) {
    let half = (0.5 * corner).tan();
    let (gain, pole) = (1.0 / (1.0 + half), (1.0 - half) / (1.0 + half));
    let mut before = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
    let mut out = 0.0;
    for x in samples {
        out = pole * out + gain * (*x - before);
        before = *x;
        *x = out;
    }
}

/// Samples that come `by` samples later, with straight lines between them; the first one stands for what
/// was before.
fn lag(samples: &mut [f64], by: f64) {
    let original = samples.to_vec();
    for (i, x) in samples.iter_mut().enumerate() {
        let at = (i as f64 - by).max(0.0);
        let (whole, part) = (at.floor(), at.fract());
        let [low, high] = [whole as usize, (whole as usize + 1).min(original.len() - 1)];
        *x = (1.0 - part) * original[low] + part * original[high];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const COUNT: usize = 20_000;

    fn wave(frequency: f64, shift: f64) -> Vec<f64> {
        let at = |i: usize| (frequency * (i as f64 - shift)).cos();
        (0..COUNT).map(at).collect()
    }

    /// Its amplitude and phase over whole periods of its second half.
    fn line(samples: &[f64], frequency: f64) -> [f64; 2] {
        let period = TAU / frequency;
        let from = COUNT / 2;
        let count = ((COUNT - from) as f64 / period).floor() * period;
        let [mut re, mut im] = [0.0, 0.0];
        for (i, x) in samples
            .iter()
            .enumerate()
            .skip(from)
            .take(count.round() as usize)
        {
            re += x * (frequency * i as f64).cos();
            im -= x * (frequency * i as f64).sin();
        }
        [2.0 * re.hypot(im) / count, im.atan2(re)]
    }

    #[test]
    fn a_capacitor_lowers_and_leads_at_its_corner() {
        let frequency = 0.05;
        let mut samples = wave(frequency, 0.0);
        high_pass(&mut samples, frequency);
        let [amplitude, phase] = line(&samples, frequency);
        assert!((amplitude - 0.5_f64.sqrt()).abs() < 2e-3, "{amplitude}");
        assert!((phase - TAU / 8.0).abs() < 5e-3, "{phase}");
    }

    #[test]
    fn what_is_late_is_the_same_later() {
        let mut samples = wave(0.01, 0.0);
        lag(&mut samples, 2.5);
        for (late, expected) in samples.iter().zip(wave(0.01, 2.5)).skip(3) {
            assert!((late - expected).abs() < 1e-4);
        }
    }
}
