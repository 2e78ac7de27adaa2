//! The recording of one window, and what is analysed in it.

use crate::Error;
use crate::Level;
use signal::amplitude_spectrum::amplitude_spectrum;
use signal::angle_resampling::{AngleGrid, Revolutions};
use signal::crank_angle::CrankAngle;
use signal::envelope::envelope;
use signal::kurtogram::kurtogram;
use signal::order_spectrum::order_spectrum;
use signal::phase_portrait::PhasePortrait;
use signal::welch::welch;
use signal::windows::Window;
use std::f64::consts::TAU;
use sweep::reader::{Dataset, SignalRow};

/// A part of one case's recording.
#[derive(Clone, Debug, Default)]
pub struct Response {
    /// The case.
    pub case_id: String,
    /// The file it is in, from the dataset's folder.
    pub file: String,
    /// Crank angle, running on or starting again at every revolution.
    pub crank_angle_rad: Vec<f64>,
    /// Acceleration at these angles.
    pub acceleration_m_s2: Vec<f64>,
    /// Velocity at these angles; empty where the data have none.
    pub velocity_m_s: Vec<f64>,
}

/// An amplitude spectrum of the acceleration.
#[derive(Clone, Debug, Default)]
pub struct Spectrum {
    /// Frequencies in Hz, or orders of the crank's speed.
    pub at: Vec<f64>,
    /// Amplitudes at these.
    pub amplitude_m_s2: Vec<f64>,
    /// Where among them the crank turns: its frequency in Hz, or 1.
    pub fundamental: f64,
}

/// Highest order of the crank's speed in order spectra.
const HIGHEST_ORDER: usize = 100;

/// Parts of a recording over which the spread of its levels is taken.
const PARTS: usize = 10;

/// Standard deviations of the levels of a recording from one recording to the next, m/s².
pub(crate) struct Spread {
    pub(crate) peak: f64,
    pub(crate) rms: f64,
    /// Of the root mean square above a frequency.
    pub(crate) high_rms: f64,
}

/// One channel of one window, over the crank angle.
pub struct Recording {
    case_id: String,
    file: String,
    sample_rate_hz: f64,
    acceleration: Vec<f64>,
    angle: CrankAngle,
    grid: AngleGrid,
    revolutions: Revolutions,
}

impl Recording {
    /// Reads the acceleration that sensor number `sensor` of the dataset's has of a window, and the
    /// crank angle. A dataset without crank angle is taken to run at its mean speed, from angle 0.
    ///
    /// # Errors
    /// A table that is damaged, lacks the channel, or holds samples that are no motion of a crank.
    pub(crate) fn read(dataset: &Dataset, window: usize, sensor: usize) -> Result<Self, Error> {
        Self::analyse(dataset.signal(window, sensor)?)
    }

    /// The first channel of the row.
    ///
    /// # Errors
    /// Samples that are no motion of a crank, with the place of the row.
    pub fn analyse(row: SignalRow) -> Result<Self, Error> {
        let (place, case_id) = (row.place.clone(), row.case_id.clone());
        Self::over_crank_angle(row).map_err(|error| Error::Recording {
            place,
            case_id,
            error,
        })
    }

    fn over_crank_angle(row: SignalRow) -> Result<Self, signal::Error> {
        let encoder = row.crank_angle.as_deref();
        let acceleration = row.channels.into_iter().next().unwrap_or_default();
        let count = acceleration.len();
        let angle = CrankAngle::recorded(encoder, count, row.sample_rate_hz, row.speed_rpm)?;
        let points = (angle.samples_per_revolution() / 1.01).ceil() as usize;
        let grid = AngleGrid::new(&angle, points.clamp(64, 1 << 16).next_power_of_two())?;
        let revolutions = grid.resample(&acceleration)?;
        Ok(Self {
            case_id: row.case_id,
            file: row.file,
            sample_rate_hz: row.sample_rate_hz,
            acceleration,
            angle,
            grid,
            revolutions,
        })
    }

    /// Acceleration and velocity at the samples.
    ///
    /// # Errors
    /// None in practice: the parts belong together.
    pub fn response(&self) -> Result<Response, Error> {
        let portrait = PhasePortrait::new(&self.revolutions, &self.grid, self.sample_rate_hz)?;
        let start = self.start();
        let step = TAU / self.revolutions.points_per_revolution() as f64;
        let velocity = portrait.velocity();
        // The integral has the period of the recording, so that both ends continue in the other.
        let at = |angle: &f64| {
            let position = (angle - start) / step;
            let (before, fraction) = (position.floor(), position - position.floor());
            let index = |i: f64| i.rem_euclid(velocity.len() as f64) as usize % velocity.len();
            let (a, b) = (velocity[index(before)], velocity[index(before + 1.0)]);
            a + (b - a) * fraction
        };
        Ok(Response {
            case_id: self.case_id.clone(),
            file: self.file.clone(),
            crank_angle_rad: self.angle.angles().to_vec(),
            acceleration_m_s2: self.acceleration.clone(),
            velocity_m_s: self.angle.angles().iter().map(at).collect(),
        })
    }

    /// The last whole revolution from crank angle 0, in equal parts: the lowest and the highest value of each, in the order
    /// in which they come, and what `beside` has there. A part without samples repeats the one before.
    pub fn extremes(&self, parts: usize, beside: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let angles = self.angle.angles();
        let last = angles.last().map_or(0.0, |angle| (angle / TAU).floor());
        let part_of = |angle: f64| ((angle / TAU - (last - 1.0)) * parts as f64).floor();
        let mut ends: Vec<Option<[usize; 2]>> = vec![None; parts];
        for (i, angle) in angles.iter().enumerate() {
            let part = part_of(*angle);
            if part < 0.0 || part >= parts as f64 {
                continue;
            }
            let [low, high] = ends[part as usize].get_or_insert([i, i]);
            if self.acceleration[i] < self.acceleration[*low] {
                *low = i;
            }
            if self.acceleration[i] > self.acceleration[*high] {
                *high = i;
            }
        }
        let (mut values, mut others) = (Vec::new(), Vec::new());
        let mut kept = ends.iter().flatten().next().copied().unwrap_or_default();
        for end in ends {
            kept = end.unwrap_or(kept);
            for i in [kept[0].min(kept[1]), kept[0].max(kept[1])] {
                values.push(self.acceleration.get(i).copied().unwrap_or(f64::NAN));
                others.extend(beside.get(i));
            }
        }
        (values, others)
    }

    /// What the levels of another recording of the same machine may differ by, from ten parts of
    /// this one: each long enough for a motion that repeats itself after a few revolutions.
    ///
    /// # Errors
    /// None in practice: a revolution has a spectrum.
    pub(crate) fn spread(&self, high_from_hz: f64) -> Result<Spread, Error> {
        let points = self.revolutions.points_per_revolution();
        let shaft_hz = self.sample_rate_hz / self.grid.samples_per_revolution();
        let (mut peaks, mut squares, mut high) = (Vec::new(), Vec::new(), Vec::new());
        let turns = self.revolutions.count().div_ceil(PARTS).max(1);
        for part in self.revolutions.samples().chunks_exact(turns * points) {
            peaks.push(part.iter().fold(0.0_f64, |peak, a| peak.max(a.abs())));
            squares.push(part.iter().map(|a| a * a).sum::<f64>() / part.len() as f64);
            let spectrum = amplitude_spectrum(part, points as f64, Window::Rectangular);
            let spectrum = spectrum?;
            let orders = spectrum.frequencies().zip(&spectrum.amplitude);
            let above = orders.filter(|(order, _)| order * shaft_hz >= high_from_hz);
            high.push(
                above
                    .map(|(_, amplitude)| 0.5 * amplitude * amplitude)
                    .sum(),
            );
        }
        Ok(Spread {
            peak: Level::largest(&peaks).spread,
            rms: Level::root_mean(&squares).spread,
            high_rms: Level::root_mean(&high).spread,
        })
    }

    /// The unwrapped angle of the first point of the grid: the one of its crank angles that is
    /// nearest to where revolutions from the middle of the recording begin.
    fn start(&self) -> f64 {
        let angles = self.angle.angles();
        let length = TAU * self.revolutions.count() as f64;
        let middle = 0.5 * (angles[0] + angles[angles.len() - 1]);
        let wanted = middle - 0.5 * length;
        let phase = self.revolutions.start_angle();
        phase + TAU * ((wanted - phase) / TAU).round()
    }

    /// Amplitude over frequency: rms over stretches of two revolutions, each overlapping the next
    /// by a half, through Hann windows (Welch 1967). So short a stretch does not separate neighbouring
    /// orders apart and shows what lies over them all: resonances, noise.
    ///
    /// # Errors
    /// None in practice: a recording has a revolution.
    pub fn spectrum(&self) -> Result<Spectrum, Error> {
        let revolution = self.angle.samples_per_revolution().round() as usize;
        let length = (2 * revolution).min(self.acceleration.len());
        let mut squares = vec![0.0; length / 2 + 1];
        let mut at = Vec::new();
        let stretches = self.acceleration.windows(length).step_by(revolution.max(1));
        let count = stretches.len() as f64;
        for stretch in stretches {
            let spectrum = amplitude_spectrum(stretch, self.sample_rate_hz, Window::Hann)?;
            at = spectrum.frequencies().collect();
            for (square, amplitude) in squares.iter_mut().zip(&spectrum.amplitude) {
                *square += amplitude * amplitude / count;
            }
        }
        Ok(Spectrum {
            at,
            amplitude_m_s2: squares.into_iter().map(f64::sqrt).collect(),
            fundamental: self.sample_rate_hz / self.grid.samples_per_revolution(),
        })
    }

    /// Amplitude of each order, rms over the revolutions.
    ///
    /// # Errors
    /// None in practice: no order is asked for that the grid does not have.
    pub fn order_spectrum(&self) -> Result<Spectrum, Error> {
        let highest = self.grid.highest_order().min(HIGHEST_ORDER);
        let spectrum = order_spectrum(&self.revolutions, highest)?;
        Ok(Spectrum {
            at: (1..=highest).map(|order| order as f64).collect(),
            amplitude_m_s2: spectrum.rms,
            fundamental: 1.0,
        })
    }
}

/// Samples in a segment of a density, and orders of an envelope's spectrum with the width of its bins.
const SEGMENT: usize = 1024;
const ENVELOPE_ORDERS: f64 = 20.0;
const ORDER_BIN: f64 = 0.25;
/// The narrowest band of an envelope, in orders: eight times the highest order shown.
const NARROWEST_ORDERS: f64 = 8.0 * ENVELOPE_ORDERS;

impl Recording {
    /// Frequencies in Hz and the amplitude density there, in m/s²/√Hz (Welch 1967).
    ///
    /// # Errors
    /// None in practice: a recording has two samples.
    pub(crate) fn density(&self) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let segment = SEGMENT.min(self.acceleration.len());
        let density = welch(
            &self.acceleration,
            self.sample_rate_hz,
            Window::Hann,
            segment,
        )?;
        let at = (0..density.density.len()).map(|k| k as f64 * density.resolution);
        let amplitude = density.density.iter().map(|d| d.sqrt());
        // Without the mean, which the segments do not have.
        Ok((at.skip(1).collect(), amplitude.skip(1).collect()))
    }

    /// Orders of the crank's speed and the highest amplitude of the envelope's spectrum about each,
    /// in m/s²: the envelope in the most impulsive band. None for a recording without such a band.
    pub fn envelope_spectrum(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let shaft = self.sample_rate_hz / self.grid.samples_per_revolution();
        let kurtogram = kurtogram(
            &self.acceleration,
            self.sample_rate_hz,
            NARROWEST_ORDERS * shaft,
        )
        .ok()?;
        let (band, _) = kurtogram.most_impulsive().ok()?;
        let envelope = envelope(&self.acceleration, self.sample_rate_hz, band).ok()?;
        let revolutions = self.grid.resample(&envelope).ok()?;
        let points = revolutions.points_per_revolution() as f64;
        let mean = revolutions.samples().iter().sum::<f64>() / revolutions.samples().len() as f64;
        let about_mean: Vec<f64> = revolutions.samples().iter().map(|y| y - mean).collect();
        let spectrum = amplitude_spectrum(&about_mean, points, Window::Hann).ok()?;
        let bins = (ENVELOPE_ORDERS / ORDER_BIN) as usize;
        let mut highest = vec![f64::NAN; bins];
        for (order, amplitude) in spectrum.frequencies().zip(&spectrum.amplitude) {
            let bin = (order / ORDER_BIN).round() as usize;
            if let Some(highest) = bin.checked_sub(1).and_then(|bin| highest.get_mut(bin)) {
                *highest = highest.max(*amplitude);
            }
        }
        let orders = (1..=bins).map(|bin| bin as f64 * ORDER_BIN);
        Some((orders.collect(), highest))
    }
}
