//! Noise of a sensor: what in a channel does not repeat from revolution to revolution.

use crate::angle_resampling::Revolutions;
use crate::error::Error;
use fourier::Complex64;

/// Fewest revolutions: with fewer there are too few bins between the orders.
const REVOLUTIONS: usize = 3;
/// Sectors of a revolution whose scatter is compared: wider than a contact's ringing, narrower than a
/// stroke.
const SECTORS: usize = 16;
/// Expectation of the least of sixteen standard normal numbers (Harter 1961).
const LEAST_OF_SECTORS: f64 = -1.766;
/// A bin with more than this many times the fitted power is a line, as of mains hum or of a motion
/// that repeats itself after two revolutions. Of noise, one bin in e^12, 160,000, has as much.
const LINE: f64 = 12.0;
/// Steps of the fit, and those before lines are left out.
const STEPS: usize = 60;
const ROUGH: usize = 8;

/// What does not repeat from revolution to revolution, as white plus 1/f noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nonsynchronous {
    /// Mean square of the white part, over all frequencies up to half the samples.
    pub white: f64,
    /// Mean square of the 1/f part, from 1/T (the record's length) to there.
    pub pink: f64,
    /// Scatter of the quietest sixteenth of the revolution, as a share of the mean over all. It is
    /// 1 for noise that does not depend on the crank angle, as a sensor's; less where the motion
    /// itself scatters. Mean squares of the whitened residual, freed of the bias of taking the least.
    pub steady_share: f64,
}

impl Nonsynchronous {
    /// Looks at the orders up to `highest`.
    ///
    /// Over R revolutions the discrete Fourier transform has R − 1 bins between two orders, where a
    /// signal that repeats every revolution has nothing. Their periodogram is fitted with
    /// S(f) = a + b/f by Whittle's likelihood (1953). There each bin is exponentially distributed
    /// about S: iterated least squares with the weights 1/S².
    ///
    /// # Errors
    /// Fewer than three revolutions, or `highest` not below half the points per revolution.
    pub fn new(x: &Revolutions, highest: usize) -> Result<Self, Error> {
        let (count, points) = (x.count(), x.points_per_revolution());
        if count < REVOLUTIONS {
            return Err(Error::TooFewRevolutions {
                needed: REVOLUTIONS,
                got: count as f64,
            });
        }
        if 2 * highest >= points || highest == 0 {
            return Err(Error::OutOfRange {
                what: "highest order",
                value: highest as f64,
                allowed: "from 1 to below half the points per revolution",
            });
        }
        let n = x.samples().len();
        let mut work = x.samples().to_vec();
        let spectrum = fourier::forward(&mut work);
        let between = |k: &usize| !k.is_multiple_of(count);
        let bins: Vec<usize> = (1..highest * count).filter(between).collect();
        let scale = 2.0 / (n as f64 * n as f64);
        let powers: Vec<f64> = bins
            .iter()
            .map(|k| scale * spectrum[*k].norm_sqr())
            .collect();
        let [a, b] = white_and_pink(&bins, &powers);
        let half = n / 2;
        let harmonic: f64 = (1..=half).map(|k| 1.0 / k as f64).sum();
        Ok(Self {
            white: a * half as f64,
            pink: b * harmonic,
            steady_share: steady_share(&spectrum, &bins, |k| a + b / k as f64, n, points),
        })
    }

    /// Mean square of the whole.
    pub fn mean_square(&self) -> f64 {
        self.white + self.pink
    }
}

/// The a and b, neither negative, of S = a + b/k.
fn white_and_pink(bins: &[usize], powers: &[f64]) -> [f64; 2] {
    let mean = powers.iter().sum::<f64>() / powers.len().max(1) as f64;
    let (mut a, mut b) = (median(powers) / std::f64::consts::LN_2, 0.0);
    if mean <= 0.0 {
        return [0.0; 2];
    }
    for step in 0..STEPS {
        let (mut w, mut wg, mut wgg, mut wp, mut wgp) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (k, power) in bins.iter().zip(powers) {
            let g = 1.0 / *k as f64;
            let fitted = (a + b * g).max(1e-12 * mean);
            if step >= ROUGH && *power > LINE * fitted {
                continue;
            }
            let weight = fitted.powi(-2);
            w += weight;
            wg += weight * g;
            wgg += weight * g * g;
            wp += weight * power;
            wgp += weight * g * power;
        }
        let determinant = w * wgg - wg * wg;
        let both = [
            (wp * wgg - wgp * wg) / determinant,
            (wgp * w - wp * wg) / determinant,
        ];
        [a, b] = match both {
            [a, b] if a > 0.0 && b > 0.0 => [a, b],
            [a, _] if a > 0.0 => [wp / w, 0.0],
            _ => [0.0, wgp / wgg],
        };
    }
    [a, b]
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The whitened residual's least mean square over a sector, over that of all.
fn steady_share(
    spectrum: &[Complex64],
    bins: &[usize],
    fitted: impl Fn(usize) -> f64,
    n: usize,
    points: usize,
) -> f64 {
    let mut white = vec![Complex64::ZERO; n / 2 + 1];
    for k in bins {
        white[*k] = spectrum[*k] / fitted(*k).max(f64::MIN_POSITIVE).sqrt();
    }
    let residual = fourier::inverse(white, n);
    let mut squares = [0.0; SECTORS];
    for (i, r) in residual.iter().enumerate() {
        squares[i % points * SECTORS / points] += r * r;
    }
    let mean = squares.iter().sum::<f64>() / SECTORS as f64;
    let least = squares.iter().copied().fold(f64::INFINITY, f64::min);
    // Each bin has two degrees of freedom, of which each sector has its part.
    let deviation = (2.0 * SECTORS as f64 / (2.0 * bins.len() as f64)).sqrt();
    (least / mean / (1.0 + LEAST_OF_SECTORS * deviation).max(0.1)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle_resampling::AngleGrid;
    use crate::crank_angle::CrankAngle;
    use crate::noise::pink_noise;
    use std::f64::consts::TAU;

    const POINTS: usize = 400;
    const COUNT: usize = 24;

    fn normals(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        let mut uniform = move || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            ((state >> 11) as f64 + 0.5) / (1u64 << 53) as f64
        };
        move || (-2.0 * uniform().ln()).sqrt() * (TAU * uniform()).cos()
    }

    fn measured(noise: impl Fn(usize, f64) -> f64) -> Nonsynchronous {
        let n = POINTS * COUNT;
        let angle: Vec<f64> = (0..n)
            .map(|i| (TAU * i as f64 / POINTS as f64).rem_euclid(TAU))
            .collect();
        let grid = AngleGrid::new(&CrankAngle::from_encoder(&angle).unwrap(), POINTS).unwrap();
        let x: Vec<f64> = (0..n)
            .map(|i| 200.0 * angle[i].cos() + 30.0 * (31.0 * angle[i]).sin() + noise(i, angle[i]))
            .collect();
        Nonsynchronous::new(&grid.resample(&x).unwrap(), grid.highest_order()).unwrap()
    }

    #[test]
    fn level_and_colour_of_the_noise_come_back() {
        for (rms, share) in [(3.0, 0.0_f64), (3.0, 0.3), (0.5, 0.7), (20.0, 0.3)] {
            for seed in 1..4 {
                let mut normal = normals(seed);
                let pink = pink_noise(POINTS * COUNT, rms * share.sqrt(), &mut normal).unwrap();
                let white: Vec<f64> = pink
                    .iter()
                    .map(|_| rms * (1.0 - share).sqrt() * normal())
                    .collect();
                let found = measured(|i, _| pink[i] + white[i]);
                // The 1/f part's own mean square hangs on its lowest few bins.
                let expected = (pink.iter().map(|x| x * x).sum::<f64>() / pink.len() as f64
                    + rms * rms * (1.0 - share))
                    .sqrt();
                let got = found.mean_square().sqrt();
                assert!((got / expected - 1.0).abs() < 0.08, "{got} {expected}");
                let colour = found.pink / found.mean_square();
                assert!((colour - share).abs() < 0.08, "{colour} {share}");
                assert!(found.steady_share > 0.9, "{}", found.steady_share);
            }
        }
    }

    #[test]
    fn scatter_of_the_motion_is_separated_from_noise() {
        let mut normal = normals(5);
        let noise: Vec<f64> = (0..POINTS * COUNT).map(|_| normal()).collect();
        // A blow once a revolution of random strength, and noise everywhere.
        let rattle = measured(|i, angle| noise[i] + 4.0 * noise[i] * f64::from(angle < 0.4));
        assert!(rattle.steady_share < 0.5, "{}", rattle.steady_share);
        // Every second revolution differs: lines at half orders are no noise.
        let half = measured(|i, angle| {
            let odd = if (i / POINTS).is_multiple_of(2) {
                1.0
            } else {
                -1.0
            };
            noise[i] + odd * (5.0 * angle).sin()
        });
        assert!((half.mean_square() - 1.0).abs() < 0.1, "{half:?}");
    }
}
