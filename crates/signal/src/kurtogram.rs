//! The frequency band in which a signal is most impulsive.

use crate::envelope::{Band, Spectrum};
use crate::error::{Error, positive};
use crate::spectral_kurtosis::excess;

/// Bins of the record's transform in the narrowest band. As many independent values of the
/// complex envelope make the kurtosis, whose standard error is then 2/√64 = 0.25 in noise.
const FEWEST_BINS: f64 = 64.0;

/// A band with less than this share of the variance (−80 dB) holds rounding, and is left out.
const LEAST_SHARE: f64 = 1e-8;

/// A band of the kurtogram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The band.
    pub band: Band,
    /// ⟨|c|⁴⟩/⟨|c|²⟩² − 2 of the complex envelope c: 0 for stationary Gaussian noise, −1 for a
    /// steady tone. `None` where the band holds too little.
    pub kurtosis: Option<f64>,
}

/// Kurtosis over bands of many centres and widths.
#[derive(Clone, Debug, PartialEq)]
pub struct Kurtogram {
    /// The bands, the widest first, those of one width by centre.
    pub cells: Vec<Cell>,
}

impl Kurtogram {
    /// The band of the largest kurtosis, and that kurtosis. Of equal ones the wider, then the
    /// lower.
    ///
    /// # Errors
    /// No band with a kurtosis: a signal that does not fluctuate.
    pub fn most_impulsive(&self) -> Result<(Band, f64), Error> {
        let mut best: Option<(Band, f64)> = None;
        for cell in &self.cells {
            if let Some(kurtosis) = cell.kurtosis
                && best.is_none_or(|(_, largest)| kurtosis > largest)
            {
                best = Some((cell.band, kurtosis));
            }
        }
        best.ok_or(Error::NoFluctuation)
    }
}

/// The kurtogram over 1, 2, 3, 4, 6, 8, 12, 16, ... equal bands from 0 to the Nyquist frequency,
/// down to a width of `narrowest`, Hz, or of 64 bins of the record, whichever is wider.
/// `sample_rate` in Hz.
///
/// The bands are those of the fast kurtogram, Antoni 2007, "Fast computation of the kurtogram for
/// the detection of transient faults", Mechanical Systems and Signal Processing 21(1). In place of
/// its tree of FIR filters each band is cut from one Fourier transform ([`Band`]), which costs as
/// much and lets every band have the same shape. The ends of the record, where the filter sees
/// both, are left out: 2/width to either side.
///
/// # Errors
/// Fewer than 128 samples, one that is not finite, a rate or a width that is not positive, or a
/// `narrowest` beyond the Nyquist frequency.
pub fn kurtogram(x: &[f64], sample_rate: f64, narrowest: f64) -> Result<Kurtogram, Error> {
    let spectrum = Spectrum::new(x, sample_rate)?;
    let nyquist = 0.5 * sample_rate;
    positive("narrowest frequency band, Hz", narrowest)?;
    if narrowest > nyquist {
        return Err(Error::OutOfRange {
            what: "narrowest frequency band, Hz",
            value: narrowest,
            allowed: "at most half the sample rate",
        });
    }
    let all_bins = 0.5 * x.len() as f64;
    if all_bins < FEWEST_BINS {
        return Err(Error::TooFewSamples {
            needed: 2 * FEWEST_BINS as usize,
            got: x.len(),
        });
    }
    let most = (nyquist / narrowest).min(all_bins / FEWEST_BINS) as usize;
    let least = LEAST_SHARE * spectrum.variance();
    let mut cells = Vec::new();
    for count in numbers_of_bands().take_while(|count| *count <= most) {
        let part = 1.0 / count as f64;
        for index in 0..count {
            let centre = (index as f64 + 0.5) * part;
            cells.push(Cell {
                band: Band {
                    centre: centre * nyquist,
                    width: part * nyquist,
                },
                kurtosis: kurtosis(&spectrum, centre * all_bins, part * all_bins, least),
            });
        }
    }
    Ok(Kurtogram { cells })
}

/// 1, 2, 3, 4, 6, 8, 12, ...
fn numbers_of_bands() -> impl Iterator<Item = usize> {
    let pairs = (1..60).flat_map(|level| [1 << level, 3 << (level - 1)]);
    std::iter::once(1).chain(pairs)
}

/// Of the band with this centre and width, in bins, if its mean square is above `least`.
fn kurtosis(spectrum: &Spectrum, centre: f64, width: f64, least: f64) -> Option<f64> {
    let points = ((2.0 * width).ceil() as usize).next_power_of_two();
    let envelope = spectrum.complex_envelope(centre, width, points);
    let margin = (2.0 * points as f64 / width).ceil() as usize;
    let inner = &envelope[margin..points - margin];
    let [mut second, mut fourth] = [0.0; 2];
    for c in inner {
        let square = c.norm_sqr();
        second += square;
        fourth += square * square;
    }
    let count = inner.len() as f64;
    // The mean square of the band is half that of its envelope.
    let enough = 0.5 * second / count > least;
    enough
        .then(|| excess(second / count, fourth / count))
        .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Bursts of 3 kHz every 512 samples under a strong slow sine that does not close.
    fn bursts(i: usize) -> f64 {
        let since = ((i + 100) % 512) as f64;
        let ring = (-since / 12.0).exp() * (TAU * 3000.0 * since / 16384.0).sin();
        ring + 80.0 * (TAU * 10.3 * i as f64 / 8192.0).sin()
    }

    #[test]
    fn band_of_the_bursts_is_found() {
        let x: Vec<f64> = (0..8192).map(bursts).collect();
        let kurtogram = kurtogram(&x, 16384.0, 1.0).unwrap();
        // 1, 2, 3, 4, 6, ... 64 bands of 4096/64 = 64 bins.
        assert_eq!(
            kurtogram.cells.len(),
            1 + 2 + 3 + 4 + 6 + 8 + 12 + 16 + 24 + 32 + 48 + 64
        );
        let (band, kurtosis) = kurtogram.most_impulsive().unwrap();
        assert!((band.centre - 3000.0).abs() < band.width.max(1000.0));
        assert!(kurtosis > 5.0, "{kurtosis}");
        // The slow sine alone fills the lowest of the wide bands: a tone.
        let tone = kurtogram.cells[6].kurtosis.unwrap();
        assert!(tone < 0.0, "{tone}");
    }

    #[test]
    fn narrowest_band_is_kept_to() {
        let x: Vec<f64> = (0..8192).map(bursts).collect();
        let kurtogram = kurtogram(&x, 16384.0, 2000.0).unwrap();
        assert_eq!(kurtogram.cells.len(), 1 + 2 + 3 + 4);
        let narrowest = kurtogram.cells.last().unwrap().band.width;
        assert_eq!(narrowest, 2048.0);
    }

    /// A tone in the middle of a band has a steady envelope.
    #[test]
    fn tone_has_kurtosis_minus_one() {
        let x: Vec<f64> = (0..4096)
            .map(|i| (TAU * 0.125 * f64::from(i)).cos())
            .collect();
        let cells = kurtogram(&x, 1.0, 0.2).unwrap().cells;
        assert_eq!(cells.len(), 3);
        // The line that is taken off shows at the band's lower edge.
        let kurtosis = cells[1].kurtosis.unwrap();
        assert!((kurtosis + 1.0).abs() < 1e-2, "{kurtosis}");
    }

    #[test]
    fn bad_input_is_named() {
        let short = kurtogram(&[1.0; 127], 1.0, 0.1);
        assert_eq!(
            short,
            Err(Error::TooFewSamples {
                needed: 128,
                got: 127
            })
        );
        assert!(kurtogram(&[1.0; 200], 1.0, 0.6).is_err());
        assert!(kurtogram(&[1.0; 200], 1.0, 0.0).is_err());
        let still = kurtogram(&[1.0; 200], 1.0, 0.1).unwrap();
        assert_eq!(still.most_impulsive(), Err(Error::NoFluctuation));
    }
}
