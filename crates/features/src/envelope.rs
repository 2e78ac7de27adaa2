//! Impacts in the frequency band where they stand out, and how they come with the shaft.

use crate::reason::Reason;
use crate::spectral::HIGHEST_ENVELOPE_ORDER;
use signal::angle_resampling::AngleGrid;
use signal::envelope::{Band, envelope};
use signal::kurtogram::kurtogram;
use signal::order_spectrum::order_spectrum;

/// Width of the narrowest band in orders of the shaft: the sidebands of the highest order of the
/// envelope then pass with 0.96 of their amplitude.
const NARROWEST_ORDERS: f64 = 8.0 * HIGHEST_ENVELOPE_ORDER as f64;

/// The envelope in the most impulsive band.
pub(crate) struct Envelope {
    band: Band,
    kurtosis: f64,
    /// Amplitudes of its synchronous mean at orders 1 to the highest.
    orders: Vec<f64>,
}

impl Envelope {
    pub(crate) fn new(x: &[f64], sample_rate: f64, grid: &AngleGrid) -> Result<Self, Reason> {
        let shaft = sample_rate / grid.samples_per_revolution();
        let kurtogram = kurtogram(x, sample_rate, NARROWEST_ORDERS * shaft)?;
        let (band, kurtosis) = kurtogram.most_impulsive()?;
        let revolutions = grid.resample(&envelope(x, sample_rate, band)?)?;
        let spectrum = order_spectrum(&revolutions, HIGHEST_ENVELOPE_ORDER)?;
        Ok(Self {
            band,
            kurtosis,
            orders: spectrum.of_mean.iter().map(|c| c.norm()).collect(),
        })
    }

    pub(crate) fn centre(&self) -> f64 {
        self.band.centre
    }

    pub(crate) fn width(&self) -> f64 {
        self.band.width
    }

    pub(crate) fn kurtosis(&self) -> f64 {
        self.kurtosis
    }

    /// Amplitude at `order`, 1 to the highest.
    pub(crate) fn order(&self, order: usize) -> f64 {
        self.orders[order - 1]
    }
}
