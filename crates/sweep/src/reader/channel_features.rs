//! The features of one accelerometer.

use super::numbers;
use recordings::Table;

/// The features of one channel, a value for each window; NaN where one is missing.
pub struct ChannelFeatures {
    /// The channel as features are named after it.
    channel: String,
    /// Root mean square, m/s².
    pub rms: Vec<f64>,
    /// Largest absolute value, m/s².
    pub peak: Vec<f64>,
    /// Peak over root mean square.
    pub crest_factor: Vec<f64>,
    /// Fourth moment about the mean over the square of the second.
    pub kurtosis: Vec<f64>,
    /// Amplitudes of the first and the second order of the crank's speed, m/s².
    pub orders: [Vec<f64>; 2],
    /// The frequency bands below half the sample rate.
    pub bands: Vec<Band>,
}

/// A band of frequencies.
pub struct Band {
    column: String,
    /// Its lower edge, Hz.
    pub from_hz: f64,
    /// Mean square of what lies in it, m²/s⁴.
    pub mean_square: Vec<f64>,
}

impl ChannelFeatures {
    pub(super) fn new(channel: &str, sample_rate_hz: f64) -> Self {
        Self {
            channel: channel.to_owned(),
            rms: Vec::new(),
            peak: Vec::new(),
            crest_factor: Vec::new(),
            kurtosis: Vec::new(),
            orders: [Vec::new(), Vec::new()],
            bands: bands(channel, sample_rate_hz),
        }
    }

    /// The columns that they are read from.
    pub(super) fn columns(&self) -> Vec<String> {
        let names = [
            "rms_m_s2",
            "peak_m_s2",
            "crest_factor",
            "kurtosis",
            "order_01_m_s2",
            "order_02_m_s2",
        ];
        let named = names.iter().map(|name| format!("{}.{name}", self.channel));
        let bands = self.bands.iter().map(|band| band.column.clone());
        named.chain(bands).collect()
    }

    /// Adds the rows of a table that has these columns.
    pub(super) fn append(&mut self, table: &Table) -> Result<(), recordings::Error> {
        let columns = self.columns();
        let [order_1, order_2] = &mut self.orders;
        let named = [
            &mut self.rms,
            &mut self.peak,
            &mut self.crest_factor,
            &mut self.kurtosis,
            order_1,
            order_2,
        ];
        let bands = self.bands.iter_mut().map(|band| &mut band.mean_square);
        for (values, column) in named.into_iter().chain(bands).zip(&columns) {
            values.extend(numbers(table, column)?);
        }
        Ok(())
    }

    /// Mean square about the mean of a window, m²/s⁴.
    pub fn variance(&self, window: usize) -> f64 {
        self.mean_square_from(0.0, window)
    }

    /// Root mean square of what lies in the bands of a window from a frequency on, m/s².
    pub fn rms_from(&self, from_hz: f64, window: usize) -> f64 {
        self.mean_square_from(from_hz, window).sqrt()
    }

    fn mean_square_from(&self, from_hz: f64, window: usize) -> f64 {
        let bands = self.bands.iter().filter(|band| band.from_hz >= from_hz);
        bands.fold(0.0, |sum, band| sum + band.mean_square[window])
    }
}

/// The bands of the table of features.
fn bands(channel: &str, sample_rate_hz: f64) -> Vec<Band> {
    let column = format!("{channel}_m_s2");
    let definitions = features::definitions([(column.as_str(), "m/s^2")]);
    let bands = definitions.into_iter().filter_map(|definition| {
        let (_, rest) = definition.name.split_once(".band_")?;
        Some(Band {
            from_hz: rest.split('_').next()?.parse().ok()?,
            column: definition.name,
            mean_square: Vec::new(),
        })
    });
    bands
        .filter(|band| band.from_hz < 0.5 * sample_rate_hz)
        .collect()
}
