//! A descent over a landscape with many small valleys, without derivatives.
//!
//! Energies have a few wide valleys, and many that are some hundredths of a clearance wide. A linear model of each residual
//! over a cloud of points does not see these, and its step of Gauss and Newton's method leads along the wide ones. The
//! cloud becomes narrower from step to step. (Statistical linearisation, Gelb 1974, section 6.2; without derivatives,
//! Cartis and Roberts 2019.)

use crate::likelihood::FAILED;
use crate::optimiser::LeastSquares;
use crate::statistical_linearization::DAMPING;
use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use scalar::random::{Purpose, stream};

/// Points of a cloud, for each unknown of the linear model.
const POINTS: usize = 2;
/// How much narrower each cloud is than the one before.
const NARROWER: f64 = 0.8;
/// How many there are: at the end their width is a fourteenth.
pub const CLOUDS: usize = 12;
/// Points farther from the middle of a cloud than so many of its half widths no longer count.
const NEAR: f64 = 1.3;
/// How far a step leads at most, over the half width of the cloud. Half of each step is looked at, too.
const STEP: f64 = 1.5;
/// By what the damping of a step grows until the step is short enough.
const MORE: f64 = 3.0;
const MOST_DAMPINGS: usize = 60;

/// Of descents from energies that are held against each other one of so many goes on (successive halving, Jamieson and Talwalkar 2016).
pub const KEPT: usize = 3;

/// A coordinate that moves, and half the width of the first cloud along it.
pub type Width = (usize, f64);

/// Where a descent has led.
#[derive(Clone, Debug)]
pub struct Led {
    /// Coordinates.
    pub x: Vec<f64>,
    /// What is left there, in the units of what was compared last: with lines, twice the negative logarithm of the likelihood.
    pub left: f64,
}

/// Leads each of these descents on by a cloud, all points together. `evaluated` is told how many have been, and says whether to go on.
pub fn descend(
    compared: &impl LeastSquares,
    all: &mut [Descent],
    mut evaluated: impl FnMut(u64) -> bool,
) -> bool {
    let goes_on = evaluate(compared, all, Descent::cloud, &mut evaluated)
        && evaluate(compared, all, Descent::steps, &mut evaluated);
    all.iter_mut().for_each(Descent::narrow);
    goes_on
}

/// Evaluates the points that each descent asks for, all together.
fn evaluate(
    compared: &impl LeastSquares,
    all: &mut [Descent],
    asked: impl Fn(&Descent) -> Vec<Vec<f64>>,
    evaluated: &mut impl FnMut(u64) -> bool,
) -> bool {
    let asked: Vec<Vec<Vec<f64>>> = all.iter().map(asked).collect();
    let points = asked.concat();
    let mut residuals = compared.residuals_of_all(&points).into_iter();
    for (descent, points) in all.iter_mut().zip(asked) {
        for (x, residuals) in points.into_iter().zip(&mut residuals) {
            descent.note(x, residuals);
        }
    }
    evaluated(points.len() as u64)
}

/// A point that was evaluated.
#[derive(Clone, Debug)]
struct Known {
    x: Vec<f64>,
    residuals: Vec<f64>,
    left: f64,
}

/// A descent under way.
pub struct Descent {
    start: Vec<f64>,
    widths: Vec<Width>,
    bounds: Vec<[f64; 2]>,
    /// Clouds so far.
    clouds: usize,
    /// How wide the next one is, over the first one.
    width: f64,
    known: Vec<Known>,
    /// The best of them.
    best: usize,
}

impl Descent {
    /// From `start`, within the bounds of what is compared.
    pub fn new(start: &[f64], widths: &[Width], compared: &impl LeastSquares) -> Self {
        Self {
            start: start.to_vec(),
            widths: widths.to_vec(),
            bounds: compared.bounds(),
            clouds: 0,
            width: 1.0,
            known: Vec::new(),
            best: 0,
        }
    }

    /// How many clouds it has had.
    pub fn clouds(&self) -> usize {
        self.clouds
    }

    /// Where it stands, and what is left there; nothing where no point could be simulated.
    pub fn best(&self) -> Led {
        let nowhere = Led {
            x: self.start.clone(),
            left: f64::INFINITY,
        };
        self.known.get(self.best).map_or(nowhere, |known| Led {
            x: known.x.clone(),
            left: known.left,
        })
    }

    fn note(&mut self, x: Vec<f64>, residuals: Vec<f64>) {
        if residuals.contains(&FAILED) {
            return;
        }
        let left = residuals.iter().map(|r| r * r).sum();
        self.known.push(Known { x, residuals, left });
    }

    /// The point that is so far from where it stands, over the widths of the cloud.
    fn at(&self, by: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut x = self.best().x;
        for ((place, width), by) in self.widths.iter().zip(by) {
            let [low, high] = self.bounds[*place];
            x[*place] = (x[*place] + self.width * width * by).clamp(low, high);
        }
        x
    }

    /// The next cloud; the first one has the start as well.
    fn cloud(&self) -> Vec<Vec<f64>> {
        let mut random = stream(0, self.clouds as u64, Purpose::Variation);
        let count = POINTS * (self.widths.len() + 1);
        let by = |_| self.at(self.widths.iter().map(|_| random.random_range(-1.0..1.0)));
        let start = (self.clouds == 0).then(|| self.start.clone());
        start.into_iter().chain((0..count).map(by)).collect()
    }

    /// Where a linear model over the points that are near leads, and half the way there.
    fn steps(&self) -> Vec<Vec<f64>> {
        let step = self.step();
        let both = step.iter().flat_map(|step| [step.clone(), 0.5 * step]);
        both.map(|step| self.at(step.iter().copied())).collect()
    }

    fn step(&self) -> Option<DVector<f64>> {
        let middle = self.known.get(self.best)?;
        let place = |known: &Known| -> DVector<f64> {
            let each = self.widths.iter();
            let each = each.map(|(i, width)| (known.x[*i] - middle.x[*i]) / (self.width * width));
            DVector::from_iterator(self.widths.len(), each)
        };
        let near = self.known.iter().map(|known| (place(known), known));
        let near: Vec<_> = near.filter(|(place, _)| place.amax() <= NEAR).collect();
        let unknown = self.widths.len();
        if near.len() <= unknown + 1 {
            return None;
        }
        let places = DMatrix::from_fn(near.len(), unknown + 1, |i, j| match j.checked_sub(1) {
            None => 1.0,
            Some(j) => near[i].0[j],
        });
        let residuals = DMatrix::from_fn(near.len(), middle.residuals.len(), |i, j| {
            near[i].1.residuals[j]
        });
        let linear = places.svd(true, true).solve(&residuals, f64::EPSILON);
        let linear = linear.ok()?;
        let slopes = linear.rows(1, unknown);
        let gradient = slopes * linear.row(0).transpose();
        let squares = slopes * slopes.transpose();
        let mut damping = DAMPING * squares.trace() / unknown as f64;
        for _ in 0..MOST_DAMPINGS {
            let damped = &squares + DMatrix::from_diagonal_element(unknown, unknown, damping);
            let step = damped.cholesky().map(|factor| -factor.solve(&gradient));
            if let Some(step) = step.filter(|step| step.amax() <= STEP) {
                return Some(step);
            }
            damping *= MORE;
        }
        None
    }

    /// Stands at its best point from now on, in a narrower cloud.
    fn narrow(&mut self) {
        let all = self.known.iter().enumerate();
        let best = all.min_by(|a, b| a.1.left.total_cmp(&b.1.left));
        self.best = best.map_or(0, |(i, _)| i);
        self.clouds += 1;
        self.width *= NARROWER;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A valley with its bottom at (0.1, 2, 0.05), and ripples as steep as its sides. Nothing can be simulated beyond 0.9.
    struct Ripples;

    impl LeastSquares for Ripples {
        fn bounds(&self) -> Vec<[f64; 2]> {
            vec![[-1.0, 1.0], [0.0, 3.0], [-1.0, 1.0]]
        }
        fn count(&self) -> usize {
            12
        }
        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            if x[0] > 0.9 {
                return vec![FAILED; self.count()];
            }
            let apart = [x[0] - 0.1, x[2] - 0.05];
            let row = |i: usize| {
                let phase = i as f64;
                let slopes = [phase.cos(), phase.sin()];
                let smooth: f64 = apart.iter().zip(slopes).map(|(a, s)| 10.0 * a * s).sum();
                let ripple: f64 = apart.iter().map(|a| (60.0 * a).sin()).sum();
                smooth + 0.3 * ripple * (2.0 * phase).cos()
            };
            (0..self.count()).map(row).collect()
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::zeros(self.count(), 3)
        }
    }

    #[test]
    fn descents_cross_small_valleys_and_what_does_not_move_stays() {
        let starts = [vec![-0.7, 2.5, 0.6], vec![0.95, 2.5, -0.6]];
        let widths = [(0, 0.5), (2, 0.5)];
        let new = |start: &Vec<f64>| Descent::new(start, &widths, &Ripples);
        let mut all: Vec<Descent> = starts.iter().map(new).collect();
        let mut spent = 0;
        for _ in 0..CLOUDS {
            let evaluated = |count| {
                spent += count;
                true
            };
            assert!(descend(&Ripples, &mut all, evaluated));
        }
        for led in all.iter().map(Descent::best) {
            assert!((led.x[0] - 0.1).abs() < 0.02, "{led:?}");
            assert!((led.x[2] - 0.05).abs() < 0.02, "{led:?}");
            assert_eq!(led.x[1], 2.5);
        }
        // The starts, and six points and at most two steps of each cloud.
        assert!(spent <= 2 * (1 + 12 * 8), "{spent}");
    }
}
