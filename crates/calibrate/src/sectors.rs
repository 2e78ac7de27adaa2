//! Energies by octaves of orders and sectors of the revolution.

use signal::Complex64;
use signal::order_lines::OrderLines;
use std::f64::consts::PI;
use std::ops::Range;

/// Points per revolution over which orders are found.
pub const POINTS: usize = 1024;
/// The first order of the lowest band; the bands are octaves.
pub(crate) const FIRST: usize = 8;
/// Least and greatest number of sectors of a band, and its orders to a sector: a band does not resolve more.
const SECTORS: [usize; 2] = [4, 24];
const ORDERS: usize = 2;
/// By this factor sectors of noise differ less than those of a motion that scatters, which does so where something knocks.
pub(crate) const KNOCKING: f64 = 4.0;

/// The sectors of one band.
pub(crate) struct Sectors {
    /// The orders of the band.
    pub orders: Range<usize>,
    /// How many there are.
    pub count: usize,
    /// The sector that each point of the grid lies in, and its share in that; the rest is the next sector's.
    shares: Vec<(usize, f64)>,
}

impl Sectors {
    /// Those of each band up to the highest of these orders.
    pub fn of_channel(orders: &[usize]) -> Vec<Self> {
        bands(orders).map(Self::new).collect()
    }

    /// Sectors overlap by half.
    fn new(orders: Range<usize>) -> Self {
        let count = count(&orders);
        let width = POINTS as f64 / count as f64;
        let share = |point: usize| {
            let place = point as f64 / width;
            let share = 0.5 * (1.0 + (PI * place.fract()).cos());
            (place.floor() as usize, share)
        };
        Self {
            orders,
            count,
            shares: (0..POINTS).map(share).collect(),
        }
    }

    /// The signal of the band's orders over the grid of crank angles.
    pub fn signal(&self, lines: &[Complex64]) -> Vec<Complex64> {
        let mut signal = vec![Complex64::ZERO; POINTS];
        for k in self.orders.clone() {
            signal[k] = lines.get(k).copied().unwrap_or_default();
        }
        fourier::inverse_complex(&mut signal);
        signal
    }

    /// Means of a function of the grid over the sectors.
    pub fn means(&self, of: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut means = vec![0.0; self.count];
        for (point, (sector, share)) in self.shares.iter().enumerate() {
            let value = of(point);
            means[*sector] += share * value;
            means[(sector + 1) % self.count] += (1.0 - share) * value;
        }
        let scale = self.count as f64 / POINTS as f64;
        means.iter().map(|mean| mean * scale).collect()
    }

    /// The energy of each sector.
    pub fn energies(&self, lines: &[Complex64]) -> Vec<f64> {
        let signal = self.signal(lines);
        self.means(|i| signal[i].norm_sqr())
    }
}

/// The bands up to the highest of these orders.
pub(crate) fn bands(orders: &[usize]) -> impl Iterator<Item = Range<usize>> {
    let last = orders.last().copied().unwrap_or(0);
    let firsts = std::iter::successors(Some(FIRST), |first| Some(2 * first));
    let firsts = firsts.take_while(move |first| *first <= last);
    firsts.map(move |first| first..(2 * first).min(last + 1))
}

pub(crate) fn count(orders: &Range<usize>) -> usize {
    (orders.len() / ORDERS).clamp(SECTORS[0], SECTORS[1])
}

/// How many sectors each band up to the highest of these orders has.
pub(crate) fn counts(orders: &[usize]) -> impl Iterator<Item = usize> {
    bands(orders).map(|orders| count(&orders))
}

/// The energies in the sectors of each band up to the highest of these orders that revolutions have beside the mean of every other
/// one: from how the lines of each differ from the mean. A motion that repeats itself after two has none.
pub(crate) fn scatter(orders: &[usize], deviations: &[Vec<Complex64>]) -> Vec<f64> {
    let mut deviations = deviations.to_vec();
    for parity in 0..2 {
        subtract_mean(deviations.iter_mut().skip(parity).step_by(2).collect());
    }
    let degrees = deviations.len().saturating_sub(2).max(1) as f64;
    let of_band = |sectors: Sectors| {
        let mut sum = vec![0.0; sectors.count];
        for lines in &deviations {
            let energies = sectors.energies(lines);
            sum.iter_mut()
                .zip(energies)
                .for_each(|(sum, energy)| *sum += energy);
        }
        sum.into_iter().map(move |sum| sum / degrees)
    };
    let sectors = Sectors::of_channel(orders).into_iter();
    sectors.flat_map(of_band).collect()
}

fn subtract_mean(mut all: Vec<&mut Vec<Complex64>>) {
    let share = 1.0 / all.len().max(1) as f64;
    for k in 0..all.first().map_or(0, |lines| lines.len()) {
        let mean: Complex64 = all.iter().map(|lines| share * lines[k]).sum();
        all.iter_mut().for_each(|lines| lines[k] -= mean);
    }
}

/// The noise in the scatter of a band's sectors, which is alike in all of them: that `between` the orders, where half orders, in which a
/// motion of two revolutions stands, do not count; or that of the quietest sector, which has no more.
pub(crate) fn noise(scatter: &[f64], between: f64) -> f64 {
    scatter.iter().copied().fold(between, f64::min)
}

/// Whether more than this noise is in the scatter of a band's sectors.
pub(crate) fn knocks(scatter: &[f64], noise: f64) -> bool {
    let greatest = scatter.iter().copied().fold(0.0, f64::max);
    greatest > KNOCKING * noise
}

/// The noise of single revolutions in a band, from that of their mean.
pub(crate) fn between_orders(lines: &OrderLines, orders: Range<usize>) -> f64 {
    let variance: f64 = orders.filter_map(|k| lines.variance.get(k)).sum();
    lines.revolutions as f64 * variance
}
