//! What the signals hold at frequencies, at orders of the shaft and in its revolutions.

use crate::Window;
use crate::reason::Reason;
use signal::amplitude_spectrum::band_mean_squares;
use signal::angle_resampling::{AngleGrid, Revolutions};
use signal::cepstrum::real_cepstrum;
use signal::crank_angle::CrankAngle;
use signal::crank_waterfall::crank_waterfall;
use signal::order_spectrum::{OrderSpectrum, order_spectrum};
use signal::spectral_shape::{SpectralShape, spectral_shape};
use signal::welch::welch;
use signal::windows;

/// Edges of the frequency bands, Hz: octaves, the first reaching down to 0 and the last up to
/// the Nyquist frequency, whatever it is. They are the same for every sample rate, so that
/// recordings can be compared.
pub(crate) const BAND_EDGES_HZ: [f64; 10] = [
    0.0,
    20.0,
    40.0,
    80.0,
    160.0,
    320.0,
    640.0,
    1280.0,
    2560.0,
    f64::INFINITY,
];

/// Orders 1 to this have a feature each.
pub(crate) const HIGHEST_ORDER: usize = 20;

/// Orders 1 to this of the envelope have a feature each.
pub(crate) const HIGHEST_ENVELOPE_ORDER: usize = 5;

/// Sectors of the crank angle, 30° each.
pub(crate) const SECTORS: usize = 12;

/// Longest segment of the spectrum whose shape is told, in samples.
const LONGEST_SEGMENT: usize = 2048;

/// Mean squares in the bands. A Hann window keeps the strong low orders from leaking into the
/// high bands.
pub(crate) fn bands(x: &[f64], sample_rate: f64) -> Result<Vec<f64>, Reason> {
    let window = windows::Window::Hann;
    Ok(band_mean_squares(x, sample_rate, window, &BAND_EDGES_HZ)?)
}

/// The value of one band, if it begins below the Nyquist frequency.
pub(crate) fn band(bands: &[f64], index: usize, sample_rate: f64) -> Result<f64, Reason> {
    let low_hz = BAND_EDGES_HZ[index];
    let nyquist_hz = 0.5 * sample_rate;
    if low_hz < nyquist_hz {
        return Ok(bands[index]);
    }
    Err(Reason::BandAboveNyquist { low_hz, nyquist_hz })
}

/// The equally spaced crank angles at which a window is resampled: a power of two per
/// revolution, not below its samples per revolution (but for the 1 % that the grid allows).
pub(crate) fn angle_grid(window: &Window) -> Result<AngleGrid, Reason> {
    let angle = crank_angle(window)?;
    let per_revolution = (angle.samples_per_revolution() / 1.01).ceil() as usize;
    // Below 64 the orders would not fit; above 65 536 there is more detail than an encoder's.
    let points = per_revolution.clamp(64, 1 << 16).next_power_of_two();
    Ok(AngleGrid::new(&angle, points)?)
}

/// The crank angle of a window: as recorded, or of a constant speed.
pub(crate) fn crank_angle(window: &Window) -> Result<CrankAngle, Reason> {
    let angle = match window.crank_angle {
        Some(readings) => {
            let readings: Vec<f64> = readings.iter().map(|a| f64::from(*a)).collect();
            CrankAngle::from_encoder(&readings)?
        }
        None => {
            let samples = window.channels.first().map_or(0, |c| c.samples.len());
            let speed_rpm = window.speed_rpm.ok_or(Reason::NoSpeed)?;
            CrankAngle::from_speed(samples, window.sample_rate, speed_rpm)?
        }
    };
    Ok(angle)
}

/// Orders 1 to [`HIGHEST_ORDER`] of a channel.
pub(crate) struct Orders {
    spectrum: OrderSpectrum,
    highest: usize,
}

impl Orders {
    pub(crate) fn new(x: &Revolutions, grid: &AngleGrid) -> Result<Self, Reason> {
        Ok(Self {
            spectrum: order_spectrum(x, HIGHEST_ORDER)?,
            highest: grid.highest_order(),
        })
    }

    /// Amplitude of the synchronous mean at `order`.
    pub(crate) fn of_mean(&self, order: usize) -> Result<f64, Reason> {
        self.resolved(order)?;
        Ok(self.spectrum.of_mean[order - 1].norm())
    }

    /// RMS over the revolutions of their amplitudes at `order`.
    pub(crate) fn rms(&self, order: usize) -> Result<f64, Reason> {
        self.resolved(order)?;
        Ok(self.spectrum.rms[order - 1])
    }

    fn resolved(&self, order: usize) -> Result<(), Reason> {
        let highest = self.highest;
        if order > highest {
            return Err(Reason::OrderTooHigh { order, highest });
        }
        Ok(())
    }
}

/// The shape of the Welch spectrum over segments of a power of two, a quarter of the record or
/// less, so that seven segments or more are averaged.
pub(crate) fn shape(x: &[f64], sample_rate: f64) -> Result<SpectralShape, Reason> {
    let quarter = (x.len() / 4).clamp(2, LONGEST_SEGMENT);
    let segment = 1 << quarter.ilog2();
    let spectrum = welch(x, sample_rate, windows::Window::Hann, segment)?;
    Ok(spectral_shape(&spectrum)?)
}

/// RMS per sector of the crank angle over all revolutions.
pub(crate) fn sectors(x: &Revolutions) -> Result<Vec<f64>, Reason> {
    Ok(crank_waterfall(x, SECTORS)?.sector_rms())
}

/// The cepstrum over the crank angle at the quefrency of one revolution.
pub(crate) fn cepstrum_at_revolution(x: &Revolutions) -> Result<f64, Reason> {
    if x.count() < 2 {
        return Err(signal::Error::TooFewRevolutions {
            needed: 2,
            got: x.count() as f64,
        }
        .into());
    }
    Ok(real_cepstrum(x.samples())?[x.points_per_revolution()])
}
