//! Where model and recording disagree: the residual over crank angle and orders.
//!
//! The orders of a channel are taken in bands. The residual's part in a band is a waveform over the
//! crank angle, whose mean square in a sector is compared with that of the noise. Under noise alone
//! their ratio is distributed as χ²/ν, with ν the independent values of the sector. Which cells count
//! is decided with the false discovery rate controlled (Benjamini and Hochberg 1995).

use crate::model::Model;
use calibrate::Error;
use calibrate::likelihood::Likelihood;
use calibrate::observation::Observed;
use calibrate::prediction::Prediction;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Sectors of a revolution.
pub const SECTORS: usize = 24;
/// The first orders of the bands; each ends where the next begins.
pub const BANDS: [usize; 9] = [1, 3, 6, 11, 21, 41, 81, 161, 321];
/// Share of false discoveries among the cells that are called significant.
const FALSE_DISCOVERIES: f64 = 0.05;
/// Angles per sector at which a band's waveform is looked at.
const ANGLES: usize = 32;

/// The residual of a channel of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ResidualMap {
    /// The run.
    pub run: String,
    /// Its speed, rad/s.
    pub speed: f64,
    /// The channel's column.
    pub channel: String,
    /// Root mean square of the residual over the revolution, SI.
    pub rms: f64,
    /// The same of the noise.
    pub noise: f64,
    /// For each band the ratio of the residual's root mean square to the noise's in each sector.
    pub excess: Vec<Vec<f64>>,
    /// Whether that is significant.
    pub significant: Vec<Vec<bool>>,
}

/// A part of the cycle in which model and recording disagree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// The run.
    pub run: String,
    /// The channel's column.
    pub channel: String,
    /// From and to, degrees of crank angle; the end may be beyond 360.
    pub crank_angle_deg: [f64; 2],
    /// First and last order.
    pub order: [usize; 2],
    /// Root mean square of the residual there over that of the noise.
    pub excess: f64,
}

/// The bands in words.
pub fn band_names() -> Vec<String> {
    let edges = BANDS.windows(2);
    edges
        .map(|edge| format!("{} to {}", edge[0], edge[1] - 1))
        .collect()
}

/// The maps of all channels of all runs.
///
/// # Errors
/// A run that cannot be simulated.
pub fn residual_maps(model: &Model) -> Result<Vec<ResidualMap>, Error> {
    let predictions = Likelihood::new(&model.problem).predictions(&model.x)?;
    let mut maps = Vec::new();
    let mut cells = Vec::new();
    for (run, prediction) in model.problem.runs.iter().zip(&predictions) {
        for (index, channel) in run.channels.iter().enumerate() {
            let bands = bands(channel, prediction, index);
            for (band, b) in bands.iter().enumerate() {
                for (sector, ratio) in b.ratios.iter().enumerate() {
                    cells.push((tail(*ratio, b.freedom), maps.len(), band, sector));
                }
            }
            let squares = |of: fn(&Band) -> f64| bands.iter().map(of).sum::<f64>().sqrt();
            maps.push(ResidualMap {
                run: run.id.clone(),
                speed: run.crank.speed,
                channel: channel.column.clone(),
                rms: squares(|b| b.square),
                noise: squares(|b| b.noise),
                excess: bands
                    .iter()
                    .map(|b| b.ratios.iter().map(|r| r.sqrt()).collect())
                    .collect(),
                significant: bands.iter().map(|_| vec![false; SECTORS]).collect(),
            });
        }
    }
    // The greatest p-value below its share of the allowed false discoveries, and all smaller ones.
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let count = cells.len() as f64;
    let allowed = |i: usize| FALSE_DISCOVERIES * (i + 1) as f64 / count;
    let last = (0..cells.len()).rev().find(|i| cells[*i].0 <= allowed(*i));
    for (_, map, band, sector) in &cells[..last.map_or(0, |last| last + 1)] {
        maps[*map].significant[*band][*sector] = true;
    }
    Ok(maps)
}

/// The significant cells of maps, neighbouring sectors of a band taken together, the greatest
/// excess first; at most `most`.
pub fn places(maps: &[ResidualMap], most: usize) -> Vec<Place> {
    let mut places: Vec<Place> = maps.iter().flat_map(of_map).collect();
    places.sort_by(|a, b| b.excess.total_cmp(&a.excess));
    places.truncate(most);
    places
}

fn of_map(map: &ResidualMap) -> Vec<Place> {
    let mut places = Vec::new();
    for (band, significant) in map.significant.iter().enumerate() {
        let place = |first: usize, count: usize| {
            let of = |i: usize| map.excess[band][(first + i) % SECTORS].powi(2);
            let sector = 360.0 / SECTORS as f64;
            Place {
                run: map.run.clone(),
                channel: map.channel.clone(),
                crank_angle_deg: [first as f64 * sector, (first + count) as f64 * sector],
                order: [BANDS[band], BANDS[band + 1] - 1],
                excess: ((0..count).map(of).sum::<f64>() / count as f64).sqrt(),
            }
        };
        let Some(gap) = significant.iter().position(|s| !s) else {
            places.push(place(0, SECTORS));
            continue;
        };
        let mut length = 0;
        for i in 1..=SECTORS {
            let sector = (gap + i) % SECTORS;
            if significant[sector] {
                length += 1;
            } else if length > 0 {
                places.push(place((sector + SECTORS - length) % SECTORS, length));
                length = 0;
            }
        }
    }
    places
}

/// A band of orders of a channel.
struct Band {
    /// Mean square of the residual and of the noise in it.
    square: f64,
    noise: f64,
    /// Their ratio in each sector.
    ratios: Vec<f64>,
    /// Independent values in a sector.
    freedom: f64,
}

fn bands(channel: &Observed, prediction: &Prediction, index: usize) -> Vec<Band> {
    let last = channel.orders.last().copied().unwrap_or(0);
    let predicted = &prediction.lines[index].amplitude;
    let edges = BANDS.windows(2).map(|edge| [edge[0], edge[1] - 1]);
    edges
        .take_while(|[low, _]| *low <= last)
        .map(|[low, high]| {
            let orders: Vec<usize> = (low..=high.min(last)).collect();
            let parts: Vec<_> = orders
                .iter()
                .map(|k| {
                    predicted.get(*k).copied().unwrap_or_default() - channel.lines.amplitude[*k]
                })
                .collect();
            // A line of variance v adds v/2 to the mean square.
            let noise: f64 = orders
                .iter()
                .map(|k| 0.5 * channel.lines.variance[*k])
                .sum();
            let at = |angle: f64| -> f64 {
                let each = orders.iter().zip(&parts);
                each.map(|(k, c)| {
                    let (s, cosine) = (*k as f64 * angle).sin_cos();
                    c.re * cosine - c.im * s
                })
                .sum()
            };
            let ratios: Vec<f64> = (0..SECTORS)
                .map(|sector| {
                    let angle = |i: usize| {
                        let share = (i as f64 + 0.5) / ANGLES as f64;
                        TAU * (sector as f64 + share) / SECTORS as f64
                    };
                    let squares: f64 = (0..ANGLES).map(|i| at(angle(i)).powi(2)).sum();
                    squares / ANGLES as f64 / noise.max(f64::MIN_POSITIVE)
                })
                .collect();
            Band {
                square: parts
                    .iter()
                    .map(|c| 0.5 * (c.re * c.re + c.im * c.im))
                    .sum(),
                noise,
                ratios,
                freedom: (2.0 * orders.len() as f64 / SECTORS as f64).max(1.0),
            }
        })
        .collect()
}

/// Probability that χ²/ν of noise is greater than `ratio`: Wilson and Hilferty's (1931) normal
/// approximation.
fn tail(ratio: f64, freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    normal_tail((ratio.cbrt() - (1.0 - spread)) / spread.sqrt())
}

/// Probability that a standard normal number is greater than `z` (Abramowitz and Stegun 1964,
/// 26.2.17: within 7.5e-8).
fn normal_tail(z: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * z.abs());
    let coefficients = [
        0.319_381_530,
        -0.356_563_782,
        1.781_477_937,
        -1.821_255_978,
        1.330_274_429,
    ];
    let polynomial = coefficients.iter().rev().fold(0.0, |sum, c| (sum + c) * t);
    let tail = (-0.5 * z * z).exp() / TAU.sqrt() * polynomial;
    if z < 0.0 { 1.0 - tail } else { tail }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of the normal and the χ² distribution.
    #[test]
    fn tails_are_those_of_the_tables() {
        for (z, p) in [
            (0.0, 0.5),
            (1.0, 0.158_655),
            (1.959_964, 0.025),
            (-1.0, 0.841_345),
        ] {
            assert!((normal_tail(z) - p).abs() < 1e-6, "{z}");
        }
        for (ratio, freedom, p) in [(3.841, 1.0, 0.05), (1.831, 10.0, 0.05), (2.321, 10.0, 0.01)] {
            assert!(
                (tail(ratio, freedom) / p - 1.0).abs() < 0.1,
                "{}",
                tail(ratio, freedom)
            );
        }
    }

    #[test]
    fn neighbouring_sectors_are_one_place_even_across_the_dead_centre() {
        let mut significant = vec![false; SECTORS];
        for sector in [0, 1, 23, 5] {
            significant[sector] = true;
        }
        let map = ResidualMap {
            run: "run".into(),
            speed: 50.0,
            channel: "x".into(),
            rms: 1.0,
            noise: 1.0,
            excess: vec![vec![2.0; SECTORS]],
            significant: vec![significant],
        };
        let mut places = places(&[map], 10);
        places.sort_by(|a, b| a.crank_angle_deg[0].total_cmp(&b.crank_angle_deg[0]));
        let angles: Vec<_> = places.iter().map(|p| p.crank_angle_deg).collect();
        assert_eq!(angles, [[75.0, 90.0], [345.0, 390.0]]);
        assert_eq!(places[0].order, [1, 2]);
        assert!((places[0].excess - 2.0).abs() < 1e-12);
    }
}
