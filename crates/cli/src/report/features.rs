//! The features that the page shows: how large the acceleration is, how peaked, how violent.

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
    /// The channel as features are named after it; none where the dataset has no such channel.
    channel: Option<String>,
    sample_rate_hz: f64,
    /// Values of each of [`SHOWN`]; NaN where one is missing.
    pub(super) shown: Vec<Vec<f64>>,
    /// Root mean square above [`HIGH_FROM_HZ`], in m/s².
    pub(super) high_rms: Vec<f64>,
    /// Mean square about the mean, in m²/s⁴.
    pub(super) variance: Vec<f64>,
}

impl Measured {
    pub(super) fn new(channel: Option<&str>, sample_rate_hz: f64) -> Self {
        Self {
            channel: channel.map(str::to_owned),
            sample_rate_hz,
            shown: vec![Vec::new(); SHOWN.len()],
            high_rms: Vec::new(),
            variance: Vec::new(),
        }
    }

    /// Whether there are any.
    pub(super) fn is_there(&self) -> bool {
        self.channel.is_some()
    }

    /// The columns that they are read from.
    pub(super) fn columns(&self) -> Vec<String> {
        let bands = self.bands().into_iter().map(|(_, column)| column);
        let shown = SHOWN.iter().filter_map(|(name, ..)| self.column(name));
        shown.chain(bands).collect()
    }

    fn column(&self, feature: &str) -> Option<String> {
        Some(format!("{}.{feature}", self.channel.as_ref()?))
    }

    /// The lower edge of each band of the table, in Hz, and its column.
    fn bands(&self) -> Vec<(f64, String)> {
        let prefix = self.channel.iter();
        let definitions = prefix.flat_map(|channel| {
            features::definitions([(format!("{channel}_m_s2").as_str(), "m/s^2")])
        });
        let bands = definitions.filter_map(|definition| {
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
            match self.column(name) {
                Some(column) => self.shown[i].extend(numbers(table, &column)?),
                None => self.shown[i].extend(vec![f64::NAN; table.rows()]),
            }
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

/// Mean and standard deviation of the features over the windows of each fault.
pub(super) fn by_fault(
    windows: &Windows,
    faults: &[FaultCount],
) -> (Vec<Feature>, Vec<FeatureRow>) {
    if !windows.measured.is_there() {
        return (Vec::new(), Vec::new());
    }
    let (features, values): (Vec<Feature>, Vec<&[f64]>) =
        windows.measured.all().into_iter().unzip();
    let rows = faults.iter().map(|count| {
        let of_fault = |values: &&[f64]| {
            let own = values.iter().zip(&windows.fault);
            let own = own.filter(|(_, fault)| **fault == count.fault);
            mean_and_spread(own.map(|(value, _)| *value))
        };
        FeatureRow {
            fault: count.fault.clone(),
            windows: count.windows,
            values: values.iter().map(of_fault).collect(),
        }
    });
    (features, rows.collect())
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
