//! Points around the best one, over which residuals are linearised.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use scalar::random::{Purpose, stream};

/// Pairs of points of a cloud, for each unknown of the linear model.
const PAIRS: usize = 4;
/// Standard deviation of the coordinates in the first cloud: a few hundredths of a clearance, as wide as its valleys are.
const FIRST: f64 = 0.03;
/// The widest cloud, as a share of a coordinate's range.
const WIDEST: f64 = 0.25;

/// The points of a cloud, or of several, and their residuals.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    pub places: Vec<Vec<f64>>,
    pub residuals: Vec<Vec<f64>>,
}

/// Which axes the clouds after the first one have.
#[derive(Clone, Copy, Debug)]
pub(super) enum Axes {
    /// The coordinates.
    Coordinates,
    /// The directions that are known by themselves.
    PrincipalDirections,
}

/// How far points lie from the best one, along each of its axes, which are columns.
#[derive(Clone, Debug)]
pub(super) struct Cloud {
    pub axes: DMatrix<f64>,
    pub along: Axes,
}

impl Cloud {
    /// That of which nothing is known: along the coordinates.
    pub fn first(bounds: &[[f64; 2]], along: Axes) -> Self {
        let spread = |[low, high]: &[f64; 2]| FIRST.min(WIDEST * (high - low));
        let spreads = DVector::from_iterator(bounds.len(), bounds.iter().map(spread));
        Self {
            axes: DMatrix::from_diagonal(&spreads),
            along,
        }
    }

    /// Pairs of opposite points, within the bounds.
    pub fn points(&self, number: u64, x: &[f64], bounds: &[[f64; 2]]) -> Vec<Vec<f64>> {
        let mut random = stream(0, number, Purpose::Variation);
        // A uniform number within ±√3 has the variance 1.
        let width = 3.0_f64.sqrt();
        let pairs = (0..PAIRS * (x.len() + 1)).map(|_| {
            let along = DVector::from_fn(x.len(), |_, _| random.random_range(-width..width));
            let by = &self.axes * along;
            [moved(x, &by, bounds), moved(x, &-by, bounds)]
        });
        pairs.flatten().collect()
    }

    /// Makes it this many times as wide along these directions, columns over its axes, but not wider than it may be.
    pub fn reshape(
        &mut self,
        directions: &DMatrix<f64>,
        factors: &DVector<f64>,
        bounds: &[[f64; 2]],
    ) {
        self.axes = &self.axes * directions * DMatrix::from_diagonal(factors);
        for (mut of_coordinate, [low, high]) in self.axes.row_iter_mut().zip(bounds) {
            let widest = WIDEST * (high - low);
            let wide = of_coordinate.norm();
            if wide > widest {
                of_coordinate *= widest / wide;
            }
        }
    }
}

/// The point `by` beside `x`, within the bounds.
pub(super) fn moved(x: &[f64], by: &DVector<f64>, bounds: &[[f64; 2]]) -> Vec<f64> {
    let each = x.iter().zip(by.iter()).zip(bounds);
    each.map(|((x, by), [low, high])| (x + by).clamp(*low, *high))
        .collect()
}

/// The variance of each coordinate that may lie anywhere within its bounds.
pub(super) fn range_variances(bounds: &[[f64; 2]]) -> DVector<f64> {
    DVector::from_iterator(
        bounds.len(),
        bounds.iter().map(|[low, high]| (high - low).powi(2) / 12.0),
    )
}
