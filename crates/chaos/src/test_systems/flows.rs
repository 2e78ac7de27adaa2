//! The chaotic flows, integrated with the fourth-order Runge-Kutta method (Kutta 1901) in steps
//! small enough that its error is far below the error of any estimator.

use super::tangent::{TRANSIENT, Tangent, mean_growths, renormalise};
use scalar::Scalar;

/// An autonomous or driven differential equation.
pub(super) trait Flow<const N: usize> {
    fn derivative<S: Scalar>(&self, t: f64, y: [S; N]) -> [S; N];
}

pub(super) struct Lorenz;
pub(super) struct Roessler;
pub(super) struct Duffing;

impl Flow<3> for Lorenz {
    fn derivative<S: Scalar>(&self, _: f64, [x, y, z]: [S; 3]) -> [S; 3] {
        [(y - x) * 10.0, x * (-z + 28.0) - y, x * y - z * (8.0 / 3.0)]
    }
}

impl Flow<3> for Roessler {
    fn derivative<S: Scalar>(&self, _: f64, [x, y, z]: [S; 3]) -> [S; 3] {
        [-y - z, x + y * 0.2, z * (x - 5.7) + 0.2]
    }
}

impl Flow<2> for Duffing {
    fn derivative<S: Scalar>(&self, t: f64, [x, v]: [S; 2]) -> [S; 2] {
        let drive = 0.5 * (1.2 * t).cos();
        [v, x - v * 0.3 - x * x * x + drive]
    }
}

/// Steps in one sample.
const STEPS: usize = 10;

/// The state `interval` later.
pub(super) fn advance<S: Scalar, const N: usize>(
    flow: &impl Flow<N>,
    t: f64,
    mut y: [S; N],
    interval: f64,
) -> [S; N] {
    let h = interval / STEPS as f64;
    let shifted = |y: [S; N], k: [S; N], by: f64| std::array::from_fn(|i| y[i] + k[i] * by);
    for step in 0..STEPS {
        let t = t + step as f64 * h;
        let k1 = flow.derivative(t, y);
        let k2 = flow.derivative(t + h / 2.0, shifted(y, k1, h / 2.0));
        let k3 = flow.derivative(t + h / 2.0, shifted(y, k2, h / 2.0));
        let k4 = flow.derivative(t + h, shifted(y, k3, h));
        y = std::array::from_fn(|i| y[i] + (k1[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * (h / 6.0));
    }
    y
}

/// The Mackey-Glass equation with its memory of one delay.
pub(super) struct MackeyGlass<S> {
    x: S,
    /// Values of the last delay and their slopes, oldest at `oldest`.
    values: Vec<S>,
    slopes: Vec<S>,
    oldest: usize,
}

/// Steps in the delay of 17 s, and in a sample of 2.5 s.
const DELAY_STEPS: usize = 170;
const SAMPLE_STEPS: usize = 25;
const STEP: f64 = 0.1;

impl<S: Scalar> MackeyGlass<S> {
    /// The constant history `x`.
    pub(super) fn new(x: S) -> Self {
        Self {
            x,
            values: vec![x; DELAY_STEPS],
            slopes: vec![S::zero(); DELAY_STEPS],
            oldest: 0,
        }
    }

    fn derivative(x: S, delayed: S) -> S {
        let square = delayed * delayed;
        let fourth = square * square;
        delayed * 0.2 / (fourth * fourth * square + 1.0) - x * 0.1
    }

    fn step(&mut self) {
        let (old, next) = (self.oldest, (self.oldest + 1) % DELAY_STEPS);
        let (start, end) = (self.values[old], self.values[next]);
        // Cubic Hermite interpolation half way between two steps of the past.
        let middle = (start + end) * 0.5 + (self.slopes[old] - self.slopes[next]) * (STEP / 8.0);
        let k1 = Self::derivative(self.x, start);
        let k2 = Self::derivative(self.x + k1 * (STEP / 2.0), middle);
        let k3 = Self::derivative(self.x + k2 * (STEP / 2.0), middle);
        let k4 = Self::derivative(self.x + k3 * STEP, end);
        self.values[old] = self.x;
        self.slopes[old] = k1;
        self.oldest = next;
        self.x += (k1 + (k2 + k3) * 2.0 + k4) * (STEP / 6.0);
    }

    fn sample(&mut self) -> S {
        (0..SAMPLE_STEPS).for_each(|_| self.step());
        self.x
    }
}

impl MackeyGlass<f64> {
    pub(super) fn samples(mut self, length: usize) -> Vec<f64> {
        (0..TRANSIENT).for_each(|_| {
            self.sample();
        });
        (0..length).map(|_| self.sample()).collect()
    }
}

impl MackeyGlass<Tangent> {
    /// Mean growth of the tangent over one sample (nats), for each stretch.
    pub(super) fn growth(mut self, lengths: (usize, usize)) -> Vec<f64> {
        mean_growths(lengths, || {
            self.sample();
            let growth = renormalise(&mut self.values);
            let scale = (-growth).exp();
            self.slopes.iter_mut().for_each(|s| s.tangent[0] *= scale);
            self.x.tangent[0] *= scale;
            growth
        })
    }
}
