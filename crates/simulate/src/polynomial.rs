//! A quantity within a step as a polynomial through its values at few instants.
//!
//! No switch lies within a step, so that whatever a sensor sees is smooth there. Interpolation at Chebyshev points then comes
//! nearest to the best polynomial, and its last coefficients say how near (Trefethen 2013, Approximation Theory and
//! Approximation Practice, chapters 4 and 8; Clenshaw 1955 for the sum).

use scalar::Scalar;
use std::f64::consts::PI;

/// Instants within a step at which a quantity is evaluated.
pub(crate) const NODES: usize = 8;

/// What a polynomial may leave out, over the tolerance of the integration times the largest magnitude seen so far: less
/// than the integration itself leaves (`tests/all/sampling.rs`).
const REMAINDER: f64 = 1.0;

/// The Chebyshev points of the first kind, and what makes coefficients of the values there.
pub(crate) struct Nodes {
    /// Where they lie, as shares of a step.
    shares: [f64; NODES],
    /// Weight of each value in each coefficient.
    weights: [[f64; NODES]; NODES],
}

impl Nodes {
    pub fn new() -> Self {
        let angle = |node: usize| PI * (1.0 - (node as f64 + 0.5) / NODES as f64);
        let cosine = |angle: f64| Scalar::sin_cos(angle).1;
        let weight = |degree: usize, node: usize| {
            let whole = if degree == 0 { 1.0 } else { 2.0 };
            whole * cosine(degree as f64 * angle(node)) / NODES as f64
        };
        Self {
            shares: std::array::from_fn(|node| 0.5 + 0.5 * cosine(angle(node))),
            weights: std::array::from_fn(|degree| std::array::from_fn(|node| weight(degree, node))),
        }
    }

    /// When one of them is, in what begins at `start` and takes `length`, s.
    pub fn time(&self, [start, length]: [f64; 2], node: usize) -> f64 {
        start + length * self.shares[node]
    }

    /// When they are.
    pub fn times(&self, span: [f64; 2]) -> [f64; NODES] {
        std::array::from_fn(|node| self.time(span, node))
    }

    /// The polynomial that has these values at the nodes.
    pub fn through(&self, values: &[f64; NODES]) -> Polynomial {
        Polynomial(f64::vectorised(
            #[inline(always)]
            || {
                self.weights.map(|weights| {
                    let terms = weights.iter().zip(values);
                    terms.map(|(weight, value)| weight * value).sum()
                })
            },
        ))
    }

    /// The integral of that polynomial over what takes `length`, s (Fejér 1933, his first rule).
    pub fn integral(&self, values: &[f64; NODES], length: f64) -> f64 {
        let Polynomial(coefficients) = self.through(values);
        let even = coefficients.iter().enumerate().step_by(2);
        let terms = even.map(|(degree, c)| c / (1.0 - (degree * degree) as f64));
        length * terms.sum::<f64>()
    }

    /// The polynomial through these values; none where it leaves out more than the `tolerance` of the integration allows for values of up to
    /// `largest`, or more than these.
    pub fn near(&self, values: &[f64; NODES], largest: f64, tolerance: f64) -> Option<Polynomial> {
        let largest = values.iter().fold(largest, |l, x| l.max(x.abs()));
        let polynomial = self.through(values);
        // Not a number leaves out too much.
        (polynomial.remainder() <= REMAINDER * tolerance * largest).then_some(polynomial)
    }
}

/// The coefficients of a polynomial in Chebyshev's, over a step.
#[derive(Clone, Copy)]
pub(crate) struct Polynomial([f64; NODES]);

impl Polynomial {
    /// A bound on what higher degrees would add, where coefficients fall as those of a smooth function do.
    fn remainder(&self) -> f64 {
        self.0[NODES - 1].abs() + self.0[NODES - 2].abs()
    }

    /// Its values at `shares` of the step, in the place of what `values` held.
    pub fn evaluate(&self, shares: &[f64], values: &mut Vec<f64>) {
        values.clear();
        values.resize(shares.len(), 0.0);
        f64::vectorised(
            #[inline(always)]
            || {
                for (value, share) in values.iter_mut().zip(shares) {
                    *value = self.value(*share);
                }
            },
        );
    }

    /// By Clenshaw's recurrence.
    #[inline(always)]
    fn value(&self, share: f64) -> f64 {
        let x = share * 2.0 - 1.0;
        let twice = x * 2.0;
        let (mut last, mut sum) = (0.0, 0.0);
        let mut degree = NODES - 1;
        while degree > 0 {
            (last, sum) = (sum, twice * sum + (self.0[degree] - last));
            degree -= 1;
        }
        x * sum + (self.0[0] - last)
    }
}
