//! A linear model of residuals over a cloud of points, and what it says of the coordinates.

use super::cloud::{Axes, Cloud, Points, range_variances};
use crate::likelihood::FAILED;
use nalgebra::{DMatrix, DVector, RowDVector, SymmetricEigen};

/// A step leads this many standard deviations of the cloud far at most.
const STEP: f64 = 2.0;
/// Standard deviations by which the sum of squares in the middle of a cloud may grow by chance.
const CHANCE: f64 = 2.0;
/// A direction is shown where its slopes add so much more to the squares of the residuals than scatter alone, as a share of what
/// that adds.
const SHOWN: f64 = 1.0;
/// The damping of a step to begin with, over the most that is known of a direction, and how often it is doubled.
pub(crate) const DAMPING: f64 = 1e-6;
const DOUBLINGS: i32 = 100;

/// Whether none of these stands in for one of a run that cannot be simulated.
pub(super) fn is_simulated(residuals: &[f64]) -> bool {
    residuals.iter().all(|r| r.is_finite() && *r != FAILED)
}

/// A linear model of the residuals over a cloud, whose axes are the units of its coordinates.
pub(super) struct Linear {
    /// Directions of the axes of the next cloud, as columns, and the squares of the slopes along each, without what scatter and
    /// curvature add; none where the residuals do not show it.
    pub directions: DMatrix<f64>,
    pub along: DVector<Option<f64>>,
    /// Half the derivative of the sum of squares.
    gradient: DVector<f64>,
    /// Its covariance by the scatter of one point: that of orders that scatter together is more than the variance of each says.
    of_gradient: DMatrix<f64>,
    /// Squares of the slopes, without what scatter and curvature add. These and the gradient are 0 along directions that
    /// the residuals do not show.
    known: DMatrix<f64>,
    /// What these add to each square, the mean over the coordinates.
    pub scatter: f64,
    /// What is known before: a coordinate lies within its bounds.
    before: DMatrix<f64>,
    /// Whether the linear model leaves more than the noise of each residual, of which scatter is a part.
    pub is_curved: bool,
    /// Half the sum of squares in the middle, without scatter; and how far it is off by chance, a standard deviation.
    pub cost: f64,
    chance: f64,
}

/// Where the points of a cloud around `x` lie along its axes, with a 1 for the middle, and their residuals: a row for each that
/// can be simulated. None where there is none.
fn simulated(cloud: &Cloud, x: &[f64], points: &Points) -> Option<[DMatrix<f64>; 2]> {
    let inverse = cloud.axes.clone().try_inverse()?;
    let (mut places, mut rows) = (Vec::new(), Vec::new());
    for (point, residuals) in points.places.iter().zip(&points.residuals) {
        if is_simulated(residuals) {
            let away = DVector::from_fn(x.len(), |i, _| point[i] - x[i]);
            places.push((&inverse * away).push(1.0).transpose());
            rows.push(DVector::from_column_slice(residuals).transpose());
        }
    }
    let is_some = !rows.is_empty();
    is_some.then(|| [places, rows].map(|rows| DMatrix::from_rows(&rows)))
}

/// Least squares of each residual over where the points of a cloud lie.
struct Regression {
    /// A row for each coordinate, a column for each residual.
    slopes: DMatrix<f64>,
    /// The residuals in the middle.
    middle: RowDVector<f64>,
    /// What slopes and middle leave, a row for each point.
    left: DMatrix<f64>,
    /// Points beyond those that determine them.
    free: f64,
    /// The sum of the variances of the residuals that are left.
    variance: f64,
    /// What these add to the products of slopes.
    of_scatter: DMatrix<f64>,
}

impl Regression {
    /// `places` has a 1 in its last column. None where the points do not determine a slope.
    fn fit(places: &DMatrix<f64>, rows: &DMatrix<f64>) -> Option<Self> {
        let count = places.ncols() - 1;
        let free = places.nrows().checked_sub(count + 1);
        let free = free.filter(|free| *free > 0)? as f64;
        let normal = (places.transpose() * places).try_inverse()?;
        let model = &normal * places.transpose() * rows;
        let left = rows - places * &model;
        let variance = left.norm_squared() / free;
        Some(Self {
            slopes: model.rows(0, count).into_owned(),
            middle: model.row(count).into_owned(),
            left,
            free,
            variance,
            of_scatter: normal.view((0, 0), (count, count)) * variance,
        })
    }
}

/// By how much the mean over points of half the sum of squares is off by chance, a standard deviation.
fn chance(rows: &DMatrix<f64>) -> f64 {
    let points = rows.nrows() as f64;
    let squares = rows.row_iter().map(|row| 0.5 * row.norm_squared());
    let squares: Vec<f64> = squares.collect();
    let mean = squares.iter().sum::<f64>() / points;
    let variance = squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / points;
    (variance / points).sqrt()
}

/// The squares of slopes along these directions, where they are more than what scatter adds.
fn along(
    directions: &DMatrix<f64>,
    squares: &DMatrix<f64>,
    of_scatter: &DMatrix<f64>,
) -> DVector<Option<f64>> {
    let of = |squares: &DMatrix<f64>| (directions.transpose() * squares * directions).diagonal();
    of(squares).zip_map(&of(of_scatter), |known, by_scatter| {
        (known > SHOWN * by_scatter).then_some(known)
    })
}

impl Linear {
    /// That of a cloud around `x`. Points that cannot be simulated are left out; none where too few are left.
    pub fn fitted(cloud: &Cloud, x: &[f64], points: &Points, bounds: &[[f64; 2]]) -> Option<Self> {
        let [places, rows] = simulated(cloud, x, points)?;
        let Regression {
            slopes,
            middle,
            left,
            free,
            variance,
            of_scatter,
        } = Regression::fit(&places, &rows)?;
        let squares = &slopes * slopes.transpose() - &of_scatter;
        let directions = match cloud.along {
            Axes::Coordinates => DMatrix::identity(x.len(), x.len()),
            Axes::PrincipalDirections => squares.clone().symmetric_eigen().eigenvectors,
        };
        let along = along(&directions, &squares, &of_scatter);
        // Scatter alone leads nowhere.
        let shown = along.map(|along| f64::from(u8::from(along.is_some())));
        let projector = &directions * DMatrix::from_diagonal(&shown) * directions.transpose();
        let slopes = &projector * slopes;
        let pulled = left * slopes.transpose();
        let ranges = DMatrix::from_diagonal(&range_variances(bounds).map(f64::recip));
        Some(Self {
            gradient: &slopes * middle.transpose(),
            of_gradient: pulled.transpose() * &pulled / free,
            known: &projector * squares * &projector,
            along,
            directions,
            scatter: of_scatter.trace() / x.len() as f64,
            before: cloud.axes.transpose() * ranges * &cloud.axes,
            is_curved: variance > rows.ncols() as f64,
            cost: 0.5 * (middle.norm_squared() - variance / places.nrows() as f64),
            chance: chance(&rows),
        })
    }

    /// Whether more is left in the middle of this cloud than of another, and not by chance.
    pub fn is_worse(&self, than: &Self) -> bool {
        self.cost - than.cost > CHANCE * self.chance.hypot(than.chance)
    }

    /// What is known. What is taken off for scatter may be more than there is.
    pub fn information(&self) -> DMatrix<f64> {
        let SymmetricEigen {
            eigenvectors,
            eigenvalues,
        } = self.known.clone().symmetric_eigen();
        let known = DMatrix::from_diagonal(&eigenvalues.map(|known| known.max(0.0)));
        &eigenvectors * known * eigenvectors.transpose() + &self.before
    }

    /// The next step, over the width of the cloud: Levenberg and Marquardt's, no further than the cloud bears it.
    pub fn step(&self) -> DVector<f64> {
        let SymmetricEigen {
            eigenvectors,
            eigenvalues,
        } = self.information().symmetric_eigen();
        let along = eigenvectors.transpose() * &self.gradient;
        let step = |damping: f64| {
            let along = along.zip_map(&eigenvalues, |g, known| -g / (known + damping));
            &eigenvectors * along
        };
        let longest = STEP * (along.len() as f64).sqrt();
        let dampings = (0..DOUBLINGS).map(|i| DAMPING * 2.0_f64.powi(i) * eigenvalues.max());
        let mut steps = dampings.map(step);
        let within = steps.find(|step| step.norm() <= longest);
        within.unwrap_or_else(|| DVector::zeros(along.len()))
    }

    /// The covariance of what is found, over the width of the cloud: the recording's noise, and its scatter, which is as great as
    /// that of a simulation (the sandwich of Huber 1967).
    pub fn covariance(&self) -> DMatrix<f64> {
        let inverse = inverse(self.information().symmetric_eigen());
        &inverse + &inverse * &self.of_gradient * &inverse
    }
}

/// The covariance that belongs to this information.
pub(super) fn inverse(information: SymmetricEigen<f64, nalgebra::Dyn>) -> DMatrix<f64> {
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = information;
    let inverse = eigenvalues.map(|known| 1.0 / known.max(f64::MIN_POSITIVE));
    &eigenvectors * DMatrix::from_diagonal(&inverse) * eigenvectors.transpose()
}
