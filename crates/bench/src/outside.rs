//! What is in no catalogue: the workflow must not take it for something that is.

use serde::{Deserialize, Serialize};
use simulate::{Measured, Record, Sensor};

/// By how much too little an amplifier shows of the greatest acceleration, as a share of it.
const COMPRESSED: f64 = 0.2;

/// Something that the model cannot have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outside {
    /// Contacts of another law: Flores, Machado, Silva and Martins 2011 in place of IMPACT.
    ContactLaw,
    /// An amplifier that shows the less of an acceleration the greater it is.
    Compression,
    /// A mass, a length or an inertia that the data sheet has wrong: a correction, and no effect.
    DataSheet,
}

impl Outside {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::ContactLaw, Self::Compression, Self::DataSheet];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::ContactLaw => "contact_law",
            Self::Compression => "compression",
            Self::DataSheet => "data_sheet",
        }
    }

    /// Changes what `sensors` have recorded.
    pub fn change(self, record: &mut Record, sensors: &[Sensor]) {
        let series = sensors.iter().zip(&mut record.series);
        let accelerations = series.filter(|(sensor, _)| {
            matches!(sensor.measured, Measured::CrossheadAcceleration { .. })
        });
        for (_, samples) in accelerations {
            match self {
                Self::ContactLaw | Self::DataSheet => {}
                Self::Compression => compress(samples),
            }
        }
    }
}

/// x (1 − c |x| / max |x|).
fn compress(samples: &mut [f64]) {
    let greatest = samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if greatest > 0.0 {
        let shown = |x: f64| x * (1.0 - COMPRESSED * x.abs() / greatest);
        samples.iter_mut().for_each(|x| *x = shown(*x));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_is_shown_too_small_and_the_small_as_it_is() {
        let mut samples = vec![0.0, -10.0, 1e-6];
        compress(&mut samples);
        assert_eq!(samples[..2], [0.0, -10.0 * (1.0 - COMPRESSED)]);
        assert!((samples[2] / 1e-6 - 1.0).abs() < 1e-6);
        compress(&mut []);
    }
}
