//! The features that the page shows: how large the acceleration is, how peaked, how violent.

use super::dataset::Dataset;
use super::windows::{Windows, numbers};
use ::report::dataset_page::{FaultCount, Feature, FeatureRow};
use recordings::Table;

/// Lower edge of the bands that count as violence: the motion without clearance hardly reaches
/// order 19 at 500 rpm.
pub(super) const HIGH_FROM_HZ: f64 = 160.0;

/// Names of features in the table, what they are, and their units.
const SHOWN: [(&str, &str, &str); 6] = [
    ("rms_m_s2", "rms", "m/s²"),
    ("peak_m_s2", "peak", "m/s²"),
    ("crest_factor", "crest factor", ""),
    ("kurtosis", "kurtosis", ""),
    ("order_01_m_s2", "order 1", "m/s²"),
    ("order_02_m_s2", "order 2", "m/s²"),
];
pub(super) const RMS: usize = 0;
pub(super) const PEAK: usize = 1;
pub(super) const CREST: usize = 2;
pub(super) const KURTOSIS: usize = 3;

/// The features of one channel, by window.
pub(super) struct Measured {
    /// The channel as features are named after it.
    channel: String,
    sample_rate_hz: f64,
    /// Values of each of [`SHOWN`]; NaN where one is missing.
    pub(super) shown: Vec<Vec<f64>>,
    /// Root mean square above [`HIGH_FROM_HZ`], in m/s².
    pub(super) high_rms: Vec<f64>,
    /// Mean square about the mean, in m²/s⁴.
    pub(super) variance: Vec<f64>,
}

impl Measured {
    pub(super) fn new(channel: &str, sample_rate_hz: f64) -> Self {
        Self {
            channel: channel.to_owned(),
            sample_rate_hz,
            shown: vec![Vec::new(); SHOWN.len()],
            high_rms: Vec::new(),
            variance: Vec::new(),
        }
    }

    /// The columns that they are read from.
    pub(super) fn columns(&self) -> Vec<String> {
        let bands = self.bands().into_iter().map(|(_, column)| column);
        let shown = SHOWN.iter().map(|(name, ..)| self.column(name));
        shown.chain(bands).collect()
    }

    fn column(&self, feature: &str) -> String {
        format!("{}.{feature}", self.channel)
    }

    /// The lower edge of each band of the table, in Hz, and its column.
    fn bands(&self) -> Vec<(f64, String)> {
        let column = format!("{}_m_s2", self.channel);
        let definitions = features::definitions([(column.as_str(), "m/s^2")]);
        let bands = definitions.into_iter().filter_map(|definition| {
            let (_, rest) = definition.name.split_once(".band_")?;
            let low = rest.split('_').next()?.parse().ok()?;
            Some((low, definition.name))
        });
        bands
            .filter(|(low, _)| *low < 0.5 * self.sample_rate_hz)
            .collect()
    }

    /// Adds the rows of a table that has these columns.
    pub(super) fn append(&mut self, table: &Table) -> Result<(), recordings::Error> {
        let (mut high, mut variance) = (vec![0.0; table.rows()], vec![0.0; table.rows()]);
        for (low, column) in self.bands() {
            for (row, value) in numbers(table, &column)?.enumerate() {
                variance[row] += value;
                if low >= HIGH_FROM_HZ {
                    high[row] += value;
                }
            }
        }
        self.high_rms.extend(high.into_iter().map(f64::sqrt));
        self.variance.extend(variance);
        for (i, (name, ..)) in SHOWN.iter().enumerate() {
            let column = self.column(name);
            self.shown[i].extend(numbers(table, &column)?);
        }
        Ok(())
    }

    /// The features by name and unit, and their values.
    fn all(&self) -> Vec<(Feature, &[f64])> {
        let feature = |name: &str, unit: &str| Feature {
            name: name.to_owned(),
            unit: unit.to_owned(),
        };
        let shown = SHOWN.iter().zip(&self.shown);
        let mut all: Vec<(Feature, &[f64])> = shown
            .map(|((_, name, unit), values)| (feature(name, unit), values.as_slice()))
            .collect();
        let high = feature(&high_name(), "m/s²");
        all.insert(KURTOSIS + 1, (high, &self.high_rms));
        all
    }
}

pub(super) fn high_name() -> String {
    format!("rms above {HIGH_FROM_HZ} Hz")
}

/// Mean and standard deviation of the features over the windows of each fault, a row for each
/// sensor that judges it.
pub(super) fn by_fault(
    dataset: &Dataset,
    windows: &Windows,
    faults: &[FaultCount],
) -> (Vec<Feature>, Vec<FeatureRow>) {
    let Some(first) = windows.measured.first() else {
        return (Vec::new(), Vec::new());
    };
    let features = first.all().into_iter().map(|(feature, _)| feature);
    let row = |count: &FaultCount, sensor: usize| {
        let values = windows.measured[sensor].all().into_iter();
        let of_fault = |(_, values): (Feature, &[f64])| {
            let own = values.iter().zip(&windows.fault);
            let own = own.filter(|(_, fault)| **fault == count.fault);
            mean_and_spread(own.map(|(value, _)| *value))
        };
        FeatureRow {
            fault: count.fault.clone(),
            sensor: dataset.sensors.channels()[sensor].clone(),
            windows: count.windows,
            values: values.map(of_fault).collect(),
        }
    };
    let rows = faults.iter().flat_map(|count| {
        let judging = dataset.sensors.of_fault(&count.fault).into_iter();
        judging.map(|sensor| row(count, sensor)).collect::<Vec<_>>()
    });
    (features.collect(), rows.collect())
}

/// Mean and standard deviation of the finite values; the latter 0 for a single value.
fn mean_and_spread(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0).max(1.0)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::mean_and_spread;

    #[test]
    fn the_spread_is_that_of_a_sample() {
        let (mean, spread) = mean_and_spread([1.0, 2.0, f64::NAN, 3.0].into_iter());
        assert_eq!((mean, spread), (2.0, 1.0));
        assert_eq!(mean_and_spread([4.0].into_iter()), (4.0, 0.0));
        assert!(mean_and_spread(std::iter::empty()).0.is_nan());
    }
}
