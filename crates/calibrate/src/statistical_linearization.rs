//! The best fit of residuals that scatter, and how well they determine it.
//!
//! Neighbours of a motion that does not repeat itself part, so that it has no derivatives. Its means over many revolutions have
//! slopes, but are known up to their scatter alone. So a cloud of points is simulated, and a linear model of each residual is
//! fitted to it: its slopes are those of a statistical linearisation (Gelb 1974, section 6.2; Lefebvre, Bruyninckx and De
//! Schutter 2002), and a step of Gauss and Newton's method with them leads to the next cloud (as in iterative ensemble
//! smoothers, Chen and Oliver 2013). What the linear model does not explain is scatter and curvature; what these add to the
//! squares of the slopes is taken off, so that a coordinate that nothing shows is not taken for a known one.

use crate::error::Error;
use crate::identifiability::{Information, intervals_of};
use crate::likelihood::FAILED;
use crate::optimiser::{LeastSquares, Progress, Watch};
use nalgebra::{DMatrix, DVector, RowDVector, SymmetricEigen};
use rand::RngExt;
use scalar::random::{Purpose, stream};

/// Pairs of points of a cloud, for each unknown of the linear model.
const PAIRS: usize = 4;
/// Standard deviation of the coordinates in the first cloud: a few hundredths of a clearance, as wide as its valleys are.
const FIRST: f64 = 0.03;
/// The widest cloud, as a share of a coordinate's range.
const WIDEST: f64 = 0.25;
/// A cloud is so wide that slopes add this many times as much to the squares of the residuals as scatter does to the squares
/// of the slopes, but not less than this many standard deviations of what is known.
const OVER_SCATTER: f64 = 4.0;
const OVER_KNOWN: f64 = 2.0;
/// A cloud becomes narrower and wider along a coordinate by these factors at most.
const NARROWER: f64 = 3.0;
const WIDER: f64 = 2.0;
/// A step leads this many standard deviations of the cloud far at most, and one of less than that ends the search.
const STEP: f64 = 2.0;
const ENDED: f64 = 0.5;
/// Clouds at most, and after how many a fit that is still `far` ends.
const CLOUDS: u64 = 6;
const BEGINNING: u64 = 2;
/// Standard deviations by which the sum of squares in the middle of a cloud may grow by chance.
const CHANCE: f64 = 2.0;
/// A coordinate is shown where its slopes add so much more to the squares of the residuals than scatter alone, as a share of what
/// that adds.
const SHOWN: f64 = 1.0;
/// The damping of a step to begin with, over the most that is known of a direction, and how often it is doubled.
pub(crate) const DAMPING: f64 = 1e-6;
const DOUBLINGS: i32 = 100;

/// The best fit within bounds that clouds from `start` on lead to, and the information there. Ends early where more than the
/// misfit `far` is left after two clouds.
///
/// # Errors
/// A start that cannot be simulated.
pub(crate) fn statistical_linearization(
    problem: &impl LeastSquares,
    start: &[f64],
    far: f64,
    watch: Watch,
) -> Result<(Progress, Information), Error> {
    let bounds = problem.bounds();
    let count = problem.count();
    let residuals = problem.residuals(start);
    if !is_simulated(&residuals) {
        return Err(Error::Nothing("the start of a fit cannot be simulated"));
    }
    let mut at = Progress {
        x: start.to_vec(),
        cost: 0.5 * residuals.iter().map(|r| r * r).sum::<f64>(),
        count,
        evaluations: 1,
    };
    let mut cloud = Cloud::first(&bounds);
    let mut best: Option<Best> = None;
    let mut clouds: Vec<Points> = Vec::new();
    for number in 0..CLOUDS {
        let stopped = watch(&at).is_break();
        if stopped || (number >= BEGINNING && at.misfit() > far) {
            break;
        }
        let points = cloud.points(number, &at.x, &bounds);
        let residuals = problem.residuals_of_all(&points);
        at.evaluations += points.len() as u64;
        let Some(linear) = Linear::fitted(&cloud, &at.x, &points, &residuals, &bounds) else {
            // Too many of them cannot be simulated.
            cloud.spreads *= 1.0 / NARROWER;
            continue;
        };
        if let Some(best) = best.as_ref().filter(|best| linear.is_worse(&best.linear)) {
            at.x.clone_from(&best.next);
            cloud.spreads = &best.spreads / NARROWER;
            continue;
        }
        let step = linear.step();
        let spreads = cloud.spreads.clone();
        at.x = moved(&at.x, &spreads.component_mul(&step), &bounds);
        at.cost = linear.cost;
        if !linear.is_curved {
            clouds.push(Points {
                places: points,
                residuals,
            });
        }
        let narrowest = cloud.reshape(&linear, &bounds);
        let ends = linear.shown.iter().all(|shown| *shown)
            && narrowest > 1.0 / NARROWER
            && step.amax() < ENDED;
        best = Some(Best {
            next: at.x.clone(),
            linear,
            spreads,
        });
        if ends {
            break;
        }
    }
    let covariance = match best {
        Some(best) => {
            let best = best.with_earlier(&clouds, &bounds);
            at.x.clone_from(&best.next);
            best.covariance()
        }
        None => DMatrix::from_diagonal(&range_variances(&bounds)),
    };
    let known = intervals_of(&at.x, &bounds, &covariance);
    Ok((at, known))
}

/// By how much less the coordinates `known` are known where the others are not, but lie within their bounds: factors of their
/// standard deviations. They are known to these `spreads`.
pub(crate) fn widening(
    problem: &impl LeastSquares,
    x: &[f64],
    known: &[usize],
    spreads: &[f64],
) -> Vec<f64> {
    if known.is_empty() {
        return Vec::new();
    }
    let bounds = problem.bounds();
    let mut cloud = Cloud::first(&bounds);
    for (i, spread) in known.iter().zip(spreads) {
        // At a bound an interval may have no width.
        if *spread > 0.0 {
            cloud.spreads[*i] = OVER_KNOWN * spread;
        }
    }
    let points = cloud.points(CLOUDS, x, &bounds);
    let residuals = problem.residuals_of_all(&points);
    let Some(linear) = Linear::fitted(&cloud, x, &points, &residuals, &bounds) else {
        return vec![1.0; known.len()];
    };
    let whole = inverse(linear.information());
    let information = linear.known + DMatrix::from_diagonal(&linear.before);
    let alone = DMatrix::from_fn(known.len(), known.len(), |i, j| {
        information[(known[i], known[j])]
    });
    let alone = inverse(alone.symmetric_eigen());
    let factor = |(place, i): (usize, &usize)| (whole[(*i, *i)] / alone[(place, place)]).sqrt();
    let factors = known.iter().enumerate().map(factor);
    factors.map(|factor| factor.max(1.0)).collect()
}

/// The last cloud that was no worse than the one before.
struct Best {
    /// Where its step has led.
    next: Vec<f64>,
    linear: Linear,
    spreads: DVector<f64>,
}

/// The points of a cloud, or of several, and their residuals.
#[derive(Clone, Debug, Default)]
struct Points {
    places: Vec<Vec<f64>>,
    residuals: Vec<Vec<f64>>,
}

impl Best {
    /// The same from the points of as many of these clouds, from the last one on, as make the coordinates best known: one cloud may leave a
    /// direction unknown by chance, and over earlier ones, which are farther away, the residuals may not be linear.
    fn with_earlier(self, clouds: &[Points], bounds: &[[f64; 2]]) -> Self {
        let (at, cloud) = (
            self.next.clone(),
            Cloud {
                spreads: self.spreads.clone(),
            },
        );
        let mut points = Points::default();
        let mut best = self;
        let mut volume = f64::INFINITY;
        for of_cloud in clouds.iter().rev() {
            points.places.extend(of_cloud.places.iter().cloned());
            points.residuals.extend(of_cloud.residuals.iter().cloned());
            let linear = Linear::fitted(&cloud, &at, &points.places, &points.residuals, bounds);
            let Some(linear) = linear else {
                continue;
            };
            let known = linear.covariance().symmetric_eigenvalues();
            let logarithms: f64 = known.iter().map(|variance| variance.max(0.0).ln()).sum();
            if logarithms < volume {
                volume = logarithms;
                let step = cloud.spreads.component_mul(&linear.step());
                best = Self {
                    next: moved(&at, &step, bounds),
                    linear,
                    spreads: cloud.spreads.clone(),
                };
            }
        }
        best
    }

    /// The covariance of the coordinates.
    fn covariance(&self) -> DMatrix<f64> {
        let over = self.linear.covariance();
        DMatrix::from_fn(over.nrows(), over.ncols(), |i, j| {
            self.spreads[i] * self.spreads[j] * over[(i, j)]
        })
    }
}

/// The variance of each coordinate that may lie anywhere within its bounds.
fn range_variances(bounds: &[[f64; 2]]) -> DVector<f64> {
    DVector::from_iterator(
        bounds.len(),
        bounds.iter().map(|[low, high]| (high - low).powi(2) / 12.0),
    )
}

/// Whether none of these stands in for one of a run that cannot be simulated.
fn is_simulated(residuals: &[f64]) -> bool {
    residuals.iter().all(|r| r.is_finite() && *r != FAILED)
}

fn moved(x: &[f64], by: &DVector<f64>, bounds: &[[f64; 2]]) -> Vec<f64> {
    let each = x.iter().zip(by.iter()).zip(bounds);
    each.map(|((x, by), [low, high])| (x + by).clamp(*low, *high))
        .collect()
}

/// How far points lie from the best one, along each coordinate.
struct Cloud {
    spreads: DVector<f64>,
}

impl Cloud {
    fn first(bounds: &[[f64; 2]]) -> Self {
        let spread = |[low, high]: &[f64; 2]| FIRST.min(WIDEST * (high - low));
        Self {
            spreads: DVector::from_iterator(bounds.len(), bounds.iter().map(spread)),
        }
    }

    /// Pairs of opposite points, within the bounds.
    fn points(&self, number: u64, x: &[f64], bounds: &[[f64; 2]]) -> Vec<Vec<f64>> {
        let mut random = stream(0, number, Purpose::Variation);
        // A uniform number within ±√3 has the variance 1.
        let width = 3.0_f64.sqrt();
        let pairs = (0..PAIRS * (x.len() + 1)).map(|_| {
            let by = self
                .spreads
                .map(|spread| spread * random.random_range(-width..width));
            [moved(x, &by, bounds), moved(x, &-by, bounds)]
        });
        pairs.flatten().collect()
    }

    /// Makes it as wide as a linear model over it says, and returns by what factor it is wider where that is least.
    fn reshape(&mut self, linear: &Linear, bounds: &[[f64; 2]]) -> f64 {
        // What curvature leaves becomes less in a narrower cloud, what scatter leaves counts less in a wider one.
        let (wide, unknown) = match linear.is_curved {
            true => (OVER_KNOWN, 1.0 / NARROWER),
            false => (
                OVER_KNOWN.max((OVER_SCATTER * linear.scatter).sqrt()),
                WIDER,
            ),
        };
        let factor = |i: usize| match linear.shown[i] {
            true => (wide / linear.known[(i, i)].sqrt()).clamp(1.0 / NARROWER, WIDER),
            false => unknown,
        };
        let factors = DVector::from_fn(bounds.len(), |i, _| factor(i));
        for (i, [low, high]) in bounds.iter().enumerate() {
            self.spreads[i] = (self.spreads[i] * factors[i]).min(WIDEST * (high - low));
        }
        factors.min()
    }
}

/// A linear model of the residuals over a cloud, whose widths are the units of its coordinates.
struct Linear {
    /// Which coordinates the residuals show. All below is 0 for the others.
    shown: Vec<bool>,
    /// Half the derivative of the sum of squares.
    gradient: DVector<f64>,
    /// Its covariance by the scatter of one point: that of orders that scatter together is more than the variance of each says.
    of_gradient: DMatrix<f64>,
    /// Squares of the slopes, without what scatter and curvature add.
    known: DMatrix<f64>,
    /// What these add to each square, the mean over the coordinates.
    scatter: f64,
    /// What is known before: a coordinate lies within its bounds.
    before: DVector<f64>,
    /// Whether the linear model leaves more than the noise of each residual, of which scatter is a part.
    is_curved: bool,
    /// Half the sum of squares in the middle, without scatter; and how far it is off by chance, a standard deviation.
    cost: f64,
    chance: f64,
}

/// Where the points of a cloud around `x` lie, over its width and with a 1 for the middle, and their residuals: a row for each that
/// can be simulated. None where there is none.
fn simulated(
    cloud: &Cloud,
    x: &[f64],
    points: &[Vec<f64>],
    residuals: &[Vec<f64>],
) -> Option<[DMatrix<f64>; 2]> {
    let (mut places, mut rows) = (Vec::new(), Vec::new());
    for (point, residuals) in points.iter().zip(residuals) {
        if is_simulated(residuals) {
            let place = |i: usize| (point[i] - x[i]) / cloud.spreads[i];
            places.push(
                DVector::from_fn(x.len(), |i, _| place(i))
                    .push(1.0)
                    .transpose(),
            );
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

impl Linear {
    /// That of a cloud around `x`. Points that cannot be simulated are left out; none where too few are left.
    fn fitted(
        cloud: &Cloud,
        x: &[f64],
        points: &[Vec<f64>],
        residuals: &[Vec<f64>],
        bounds: &[[f64; 2]],
    ) -> Option<Self> {
        let [places, rows] = simulated(cloud, x, points, residuals)?;
        let Regression {
            mut slopes,
            middle,
            left,
            free,
            variance,
            of_scatter,
        } = Regression::fit(&places, &rows)?;
        let known = &slopes * slopes.transpose() - &of_scatter;
        let shown = (0..x.len()).map(|i| known[(i, i)] > SHOWN * of_scatter[(i, i)]);
        let shown: Vec<bool> = shown.collect();
        // Scatter alone leads nowhere.
        for (mut slope, shown) in slopes.row_iter_mut().zip(&shown) {
            if !shown {
                slope.fill(0.0);
            }
        }
        let pulled = left * slopes.transpose();
        let widths = cloud.spreads.map(|spread| spread.powi(2));
        Some(Self {
            gradient: &slopes * middle.transpose(),
            of_gradient: pulled.transpose() * &pulled / free,
            known: known.map_with_location(|i, j, known| match shown[i] && shown[j] {
                true => known,
                false => 0.0,
            }),
            shown,
            scatter: of_scatter.trace() / x.len() as f64,
            before: widths.component_div(&range_variances(bounds)),
            is_curved: variance > rows.ncols() as f64,
            cost: 0.5 * (middle.norm_squared() - variance / places.nrows() as f64),
            chance: chance(&rows),
        })
    }

    /// Whether more is left in the middle of this cloud than of another, and not by chance.
    fn is_worse(&self, than: &Self) -> bool {
        self.cost - than.cost > CHANCE * self.chance.hypot(than.chance)
    }

    /// What is known, with its principal directions. What is taken off for scatter may be more than there is.
    fn information(&self) -> SymmetricEigen<f64, nalgebra::Dyn> {
        let SymmetricEigen {
            eigenvectors,
            eigenvalues,
        } = self.known.clone().symmetric_eigen();
        let shown = DMatrix::from_diagonal(&eigenvalues.map(|known| known.max(0.0)));
        let shown = &eigenvectors * shown * eigenvectors.transpose();
        (shown + DMatrix::from_diagonal(&self.before)).symmetric_eigen()
    }

    /// The next step, over the width of the cloud: Levenberg and Marquardt's, no further than the cloud bears it.
    fn step(&self) -> DVector<f64> {
        let SymmetricEigen {
            eigenvectors,
            eigenvalues,
        } = self.information();
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
    fn covariance(&self) -> DMatrix<f64> {
        let inverse = inverse(self.information());
        &inverse + &inverse * &self.of_gradient * &inverse
    }
}

fn inverse(information: SymmetricEigen<f64, nalgebra::Dyn>) -> DMatrix<f64> {
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = information;
    let inverse = eigenvalues.map(|known| 1.0 / known.max(f64::MIN_POSITIVE));
    &eigenvectors * DMatrix::from_diagonal(&inverse) * eigenvectors.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;

    const COUNT: usize = 400;
    const TRUTH: [f64; 3] = [0.21, -0.3, 0.4];

    /// Residuals that feel the first coordinate strongly, the second one less and the third not at all. Half of their variance
    /// scatters from point to point, the other half is the recording's.
    struct Scattering(u64);

    impl Scattering {
        fn noise(seed: u64, index: u64) -> Vec<f64> {
            let mut random = stream(seed, index, Purpose::Noise);
            let width = 1.5_f64.sqrt();
            (0..COUNT)
                .map(|_| random.random_range(-width..width))
                .collect()
        }
    }

    impl LeastSquares for Scattering {
        fn bounds(&self) -> Vec<[f64; 2]> {
            vec![[-1.0, 1.0]; 3]
        }
        fn count(&self) -> usize {
            COUNT
        }
        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            let bits = x
                .iter()
                .fold(0, |bits: u64, x| bits.rotate_left(21) ^ x.to_bits());
            let noise = Self::noise(self.0, 0)
                .into_iter()
                .zip(Self::noise(self.0, bits));
            let apart = |i: usize| x[i] - TRUTH[i];
            let signal = |k: f64| {
                400.0 * (apart(0) + apart(0).powi(2)) * (0.3 * k).sin()
                    + 40.0 * apart(1) * (0.7 * k).cos()
            };
            noise
                .enumerate()
                .map(|(k, (own, other))| signal(k as f64) + own + other)
                .collect()
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::zeros(COUNT, 3)
        }
    }

    #[test]
    fn intervals_hold_the_truth_and_what_nothing_shows_is_not_known() {
        let mut held = [0; 2];
        for seed in 0..40 {
            let go = &mut |_: &Progress| ControlFlow::Continue(());
            let problem = Scattering(seed);
            let (found, known) =
                statistical_linearization(&problem, &[0.12, -0.25, 0.1], 1e3, go).unwrap();
            assert!(found.misfit() < 1.2, "{seed}: {}", found.misfit());
            assert_eq!(known.unidentifiable, Some(2), "{seed}");
            for (i, held) in held.iter_mut().enumerate() {
                let [low, high] = known.intervals[i];
                // Slopes of 400 and 40 times a wave of mean square 1/2, and noise of variance 1.
                let textbook = 2.0 * 1.96 / ([400.0, 40.0][i] * (0.5 * COUNT as f64).sqrt());
                let ratio = (high - low) / textbook;
                assert!((0.9..2.5).contains(&ratio), "{seed}: {ratio}");
                *held += usize::from(low <= TRUTH[i] && TRUTH[i] <= high);
            }
        }
        for held in held {
            assert!(held >= 36, "{held} of 40");
        }
    }

    /// Residuals that feel the sum of two coordinates, and the first one a little by itself.
    struct Alike;

    impl LeastSquares for Alike {
        fn bounds(&self) -> Vec<[f64; 2]> {
            vec![[-10.0, 10.0], [-0.1, 0.1]]
        }
        fn count(&self) -> usize {
            2
        }
        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            vec![100.0 * (x[0] + x[1]), 10.0 * x[0]]
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::from_row_slice(2, 2, &[100.0, 100.0, 10.0, 0.0])
        }
    }

    #[test]
    fn what_is_unknown_beside_it_widens_an_interval_as_in_the_textbook() {
        let factor = widening(&Alike, &[0.0, 0.0], &[0], &[0.01])[0];
        // Schur's complement: the first coordinate's information less what the second, of variance 0.2²/12, takes of it.
        let (alone, second) = (1e4 + 1e2, 1e4 + 12.0 / 0.04_f64);
        let expected = f64::sqrt(alone / (alone - 1e8 / second));
        assert!(
            (factor / expected - 1.0).abs() < 1e-3,
            "{factor} {expected}"
        );
        assert!(widening(&Alike, &[0.0, 0.0], &[], &[]).is_empty());
    }
}
