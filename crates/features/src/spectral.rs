//! What the signals hold at frequencies, at orders of the shaft and in its revolutions.

use crate::reason::Reason;
use crate::window::Window;
use signal::amplitude_spectrum::band_mean_squares;
use signal::angle_resampling::{AngleGrid, Revolutions};
use signal::cepstrum::real_cepstrum;
use signal::crank_angle::CrankAngle;
use signal::crank_waterfall::crank_waterfall;
use signal::order_spectrum::{OrderSpectrum, order_spectrum};
use signal::overall_vibration::OverallVibration;
use signal::segments::Segments;
use signal::spectral_shape::{SpectralShape, spectral_shape};
use signal::welch::welch_over;
use signal::windows;
use simulate::IndicatorCard;

/// Edges of the frequency bands, Hz: octaves, the first reaching down to 0 and the last up to
/// the Nyquist frequency. They are the same for every sample rate, so that
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

/// The shape of a spectrum is described up to this frequency, Hz: the last edge of the octave bands, which
/// are the same for every sample rate. What lies above has a band of its own.
pub(crate) const SHAPE_TO_HZ: f64 = 2560.0;

/// The share of the sample rate that a recorder's filter against aliasing passes; 0.5 would be the
/// Nyquist frequency. Recorders sample at 2.5 times their bandwidth or more (2.56 in analysers).
pub(crate) const PASSED: f64 = 0.4;

/// The band of overall vibration, Hz. Below it sensors drift; the lowest speed of ISO 20816-8 is 120 rpm,
/// 2 Hz. Above it the velocity of a machine is small.
pub const OVERALL_HZ: [f64; 2] = [2.0, 1000.0];

/// Length of the segments of a spectrum where no speed is known, s: a revolution at 300 rpm. That is the
/// lowest usual speed of process compressors (API 618), so that the lines of faster ones are resolved.
pub(crate) const SEGMENT_S: f64 = 0.2;

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

/// The equally spaced crank angles at which a window is resampled, as fine as its samples.
pub(crate) fn angle_grid(window: &Window) -> Result<AngleGrid, Reason> {
    Ok(AngleGrid::as_fine_as_recorded(&crank_angle(window)?)?)
}

/// The crank angle of a window: as recorded, or of a constant speed.
pub(crate) fn crank_angle(window: &Window) -> Result<CrankAngle, Reason> {
    let angle = match window.crank_angle {
        Some(crank) => {
            let readings: Vec<f64> = crank.angles.iter().map(|a| f64::from(*a)).collect();
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

/// The shape of the Welch spectrum up to [`SHAPE_TO_HZ`], or to what the sample rate resolves if that is
/// less. Its segments are one revolution long where the speed is known, [`SEGMENT_S`] elsewhere. Segments
/// of a number of samples would give one motion different shapes at different sample rates.
pub(crate) fn shape(
    x: &[f64],
    sample_rate: f64,
    grid: Result<&AngleGrid, Reason>,
) -> Result<SpectralShape, Reason> {
    let segments = match grid {
        Ok(grid) => Segments::revolutions(x.len(), grid.samples_per_revolution()),
        Err(Reason::NoSpeed) => {
            Segments::overlapping(x.len(), (SEGMENT_S * sample_rate).round() as usize)
        }
        Err(reason) => return Err(reason),
    };
    let spectrum = welch_over(x, sample_rate, windows::Window::Hann, &segments)?;
    let highest = SHAPE_TO_HZ.min(PASSED * sample_rate);
    Ok(spectral_shape(&spectrum.up_to(highest))?)
}

/// Overall vibration of an acceleration or a velocity, which its `unit` tells, over the whole revolutions of `grid`, from 2 to 1000 Hz or up to
/// what the sample rate (Hz) resolves: the values of the features `acceleration_rms`, `velocity_rms` and
/// `displacement_rms`.
///
/// # Errors
/// A channel whose length is not that of the grid, or one with a sample that is not finite.
pub fn overall_vibration(
    x: &[f64],
    unit: &str,
    sample_rate: f64,
    grid: &AngleGrid,
) -> Result<OverallVibration, signal::Error> {
    let [low, high] = OVERALL_HZ;
    let (x, at_equal_times) = grid.at_equal_times(x, sample_rate)?;
    let band = [low, high.min(PASSED * sample_rate)];
    match unit {
        "m/s" => OverallVibration::of_velocity(&x, at_equal_times, band),
        _ => OverallVibration::new(&x, at_equal_times, band),
    }
}

/// The p-V card of the channel of this name, where its chamber and top dead centre are known.
pub(crate) fn card(
    channel: &str,
    pressure: &Revolutions,
    grid: &AngleGrid,
    window: &Window,
) -> Result<IndicatorCard, Reason> {
    let mut chambers = window.chambers.iter();
    let chamber = chambers.find(|chamber| chamber.column == channel);
    let chamber = chamber.ok_or(Reason::NoChamber)?;
    match window.crank_angle {
        Some(crank) if crank.from_top_dead_centre => {
            let revolutions_per_s = window.sample_rate / grid.samples_per_revolution();
            Ok(IndicatorCard::new(chamber, pressure, revolutions_per_s))
        }
        _ => Err(Reason::NoTopDeadCentre),
    }
}

/// RMS per sector of the crank angle over all revolutions, where it counts from top dead centre.
pub(crate) fn sectors(x: &Revolutions, window: &Window) -> Result<Vec<f64>, Reason> {
    match window.crank_angle {
        Some(crank) if crank.from_top_dead_centre => Ok(crank_waterfall(x, SECTORS)?.sector_rms()),
        _ => Err(Reason::NoTopDeadCentre),
    }
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
