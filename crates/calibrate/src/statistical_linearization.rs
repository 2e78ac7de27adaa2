//! The best fit of residuals that scatter, and how well they determine it.
//!
//! Neighbours of a motion that does not repeat itself part, so that it has no derivatives. Its means over many revolutions have
//! slopes, but are known up to their scatter alone. So a cloud of points is simulated, and a linear model of each residual is
//! fitted to it: its slopes are those of a statistical linearisation (Gelb 1974, section 6.2; Lefebvre, Bruyninckx and De
//! Schutter 2002), and a step of Gauss and Newton's method with them leads to the next cloud (as in iterative ensemble
//! smoothers, Chen and Oliver 2013). What the linear model does not explain is scatter and curvature; what these add to the
//! squares of the slopes is taken off, so that a direction that nothing shows is not taken for a known one.
//!
//! Clouds along the coordinates are as wide as each of them is known where the others are. They give the narrowest intervals, but
//! do not follow a valley that is oblique to the coordinates, and bent. Clouds along the principal directions of what is known are
//! as long as such a valley, and what bends over them counts as scatter. So they come second, where more than noise is left.

mod cloud;
mod linear_model;

pub(crate) use linear_model::DAMPING;

use crate::error::Error;
use crate::identifiability::{Information, intervals_of};
use crate::likelihood::NOISE;
use crate::optimiser::{LeastSquares, Progress, Watch};
use cloud::{Axes, Cloud, Points, moved, range_variances};
use linear_model::{Linear, inverse, is_simulated};
use nalgebra::DMatrix;
use std::cmp::Ordering;

/// A cloud is so wide that slopes add this many times as much to the squares of the residuals as scatter does to the squares
/// of the slopes, but not less than this many standard deviations of what is known.
const OVER_SCATTER: f64 = 4.0;
const OVER_KNOWN: f64 = 2.0;
/// A cloud becomes narrower and wider along an axis by these factors at most.
const NARROWER: f64 = 3.0;
const WIDER: f64 = 2.0;
/// A step of less than this many standard deviations of the cloud ends the search.
const ENDED: f64 = 0.5;
/// Clouds at most along coordinates and along principal directions, and after how many a fit that is still `far` may end.
const CLOUDS: u64 = 6;
const SEARCHED: u64 = 12;
const BEGINNING: u64 = 2;

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
    let mut search = Search::new(problem, &bounds, start, far)?;
    let mut best = search.led(Axes::Coordinates, watch);
    if search.at.misfit() > NOISE && !search.stopped {
        let first = search.at.clone();
        search.at.x = start.to_vec();
        let other = search.led(Axes::PrincipalDirections, watch);
        if search.at.cost < first.cost {
            best = other;
        } else {
            let evaluations = search.at.evaluations;
            search.at = Progress {
                evaluations,
                ..first
            };
        }
    }
    let covariance = match best {
        Some(best) => best.covariance(),
        None => DMatrix::from_diagonal(&range_variances(&bounds)),
    };
    let known = intervals_of(&search.at.x, &bounds, &covariance);
    Ok((search.at, known))
}

/// A search under way.
struct Search<'a, P> {
    problem: &'a P,
    bounds: &'a [[f64; 2]],
    far: f64,
    at: Progress,
    /// Clouds so far.
    clouds: u64,
    stopped: bool,
}

impl<'a, P: LeastSquares> Search<'a, P> {
    fn new(problem: &'a P, bounds: &'a [[f64; 2]], start: &[f64], far: f64) -> Result<Self, Error> {
        let residuals = problem.residuals(start);
        if !is_simulated(&residuals) {
            return Err(Error::Nothing("the start of a fit cannot be simulated"));
        }
        let at = Progress {
            x: start.to_vec(),
            cost: 0.5 * residuals.iter().map(|r| r * r).sum::<f64>(),
            count: problem.count(),
            evaluations: 1,
        };
        Ok(Self {
            problem,
            bounds,
            far,
            at,
            clouds: 0,
            stopped: false,
        })
    }

    /// The last cloud that is no worse than the one before, of those that lead on from where the search stands. It stands where the step of
    /// that one leads then.
    fn led(&mut self, along: Axes, watch: Watch) -> Option<Best> {
        let bounds = self.bounds;
        let mut cloud = Cloud::first(bounds, along);
        let most = match along {
            Axes::Coordinates => CLOUDS,
            Axes::PrincipalDirections => SEARCHED,
        };
        let mut best: Option<Best> = None;
        let mut straight: Vec<Points> = Vec::new();
        for number in 0..most {
            self.stopped = watch(&self.at).is_break();
            // A cloud over which the residuals are curved says little of its middle.
            let is_curved = best.as_ref().is_some_and(|best| best.linear.is_curved);
            let goes_on = is_curved && matches!(along, Axes::PrincipalDirections);
            let is_far = self.at.misfit() > self.far && !goes_on;
            if self.stopped || (number >= BEGINNING && is_far) {
                break;
            }
            let points = self.points(&cloud);
            let Some(linear) = Linear::fitted(&cloud, &self.at.x, &points, bounds) else {
                // Too many of them cannot be simulated.
                cloud.axes *= 1.0 / NARROWER;
                continue;
            };
            if let Some(best) = best.as_ref().filter(|best| linear.is_worse(&best.linear)) {
                self.at.x.clone_from(&best.next);
                cloud.axes = &best.cloud.axes / NARROWER;
                continue;
            }
            if !linear.is_curved {
                straight.push(points);
            }
            let led = Best::new(cloud.clone(), &self.at.x, linear, bounds);
            self.at.x.clone_from(&led.next);
            self.at.cost = led.linear.cost;
            let narrowest = reshape(&mut cloud, &led.linear, bounds);
            let ends = led.linear.along.iter().all(Option::is_some)
                && narrowest > 1.0 / NARROWER
                && led.linear.step().amax() < ENDED;
            best = Some(led);
            if ends {
                break;
            }
        }
        let best = best?.with_earlier(straight, bounds);
        self.at.x.clone_from(&best.next);
        Some(best)
    }

    fn points(&mut self, cloud: &Cloud) -> Points {
        let places = cloud.points(self.clouds, &self.at.x, self.bounds);
        self.clouds += 1;
        self.at.evaluations += places.len() as u64;
        let residuals = self.problem.residuals_of_all(&places);
        Points { places, residuals }
    }
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
    let mut cloud = Cloud::first(&bounds, Axes::Coordinates);
    for (i, spread) in known.iter().zip(spreads) {
        // At a bound an interval may have no width.
        if *spread > 0.0 {
            cloud.axes[(*i, *i)] = OVER_KNOWN * spread;
        }
    }
    let places = cloud.points(CLOUDS, x, &bounds);
    let residuals = problem.residuals_of_all(&places);
    let Some(linear) = Linear::fitted(&cloud, x, &Points { places, residuals }, &bounds) else {
        return vec![1.0; known.len()];
    };
    let whole = inverse(linear.information().symmetric_eigen());
    let information = linear.information();
    let alone = DMatrix::from_fn(known.len(), known.len(), |i, j| {
        information[(known[i], known[j])]
    });
    let alone = inverse(alone.symmetric_eigen());
    let factor = |(place, i): (usize, &usize)| (whole[(*i, *i)] / alone[(place, place)]).sqrt();
    let factors = known.iter().enumerate().map(factor);
    factors.map(|factor| factor.max(1.0)).collect()
}

/// A cloud, the linear model over it, and where its step leads.
struct Best {
    cloud: Cloud,
    linear: Linear,
    next: Vec<f64>,
}

impl Best {
    fn new(cloud: Cloud, x: &[f64], linear: Linear, bounds: &[[f64; 2]]) -> Self {
        let next = moved(x, &(&cloud.axes * linear.step()), bounds);
        Self {
            cloud,
            linear,
            next,
        }
    }

    /// The same from the points of as many of these clouds, from the last one on, as make the coordinates best known: one cloud may leave a
    /// direction unknown by chance, and over earlier ones, which are farther away, the residuals may not be linear.
    fn with_earlier(self, clouds: Vec<Points>, bounds: &[[f64; 2]]) -> Self {
        let (at, cloud) = (self.next.clone(), self.cloud.clone());
        let mut points = Points::default();
        let mut best: Option<Self> = None;
        for of_cloud in clouds.into_iter().rev() {
            points.places.extend(of_cloud.places);
            points.residuals.extend(of_cloud.residuals);
            let linear = Linear::fitted(&cloud, &at, &points, bounds);
            let found = linear.map(|linear| Self::new(cloud.clone(), &at, linear, bounds));
            best = best.into_iter().chain(found).min_by(Self::by_volume);
        }
        best.unwrap_or(self)
    }

    /// In the order of the volume that the coordinates are known to.
    fn by_volume(one: &Self, other: &Self) -> Ordering {
        let volume = |best: &Self| {
            let known = best.linear.covariance().symmetric_eigenvalues();
            known.map(|variance| variance.max(0.0).ln()).sum()
        };
        volume(one).total_cmp(&volume(other))
    }

    /// The covariance of the coordinates.
    fn covariance(&self) -> DMatrix<f64> {
        let axes = &self.cloud.axes;
        axes * self.linear.covariance() * axes.transpose()
    }
}

/// Makes a cloud as wide as a linear model over it says, and returns by what factor it is wider where that is least.
fn reshape(cloud: &mut Cloud, linear: &Linear, bounds: &[[f64; 2]]) -> f64 {
    // What curvature leaves becomes less in a narrower cloud, what scatter leaves counts less in a wider one.
    let (wide, unknown) = match linear.is_curved {
        true => (OVER_KNOWN, 1.0 / NARROWER),
        false => (
            OVER_KNOWN.max((OVER_SCATTER * linear.scatter).sqrt()),
            WIDER,
        ),
    };
    let factor = |along: Option<f64>| match along {
        Some(known) => (wide / known.sqrt()).clamp(1.0 / NARROWER, WIDER),
        None => unknown,
    };
    let factors = linear.along.map(factor);
    cloud.reshape(&linear.directions, &factors, bounds);
    factors.min()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use scalar::random::{Purpose, stream};
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

    /// Residuals with a valley that is oblique to the coordinates, bent, and forty times as long as it is wide.
    struct Valley(u64);

    impl LeastSquares for Valley {
        fn bounds(&self) -> Vec<[f64; 2]> {
            vec![[-1.0, 1.0]; 2]
        }
        fn count(&self) -> usize {
            COUNT
        }
        fn residuals(&self, x: &[f64]) -> Vec<f64> {
            let bits = x[0].to_bits() ^ x[1].to_bits().rotate_left(21);
            let own = Scattering::noise(self.0, 0).into_iter();
            let noise = own.zip(Scattering::noise(self.0, bits));
            let [across, along] = [x[0] + x[1], x[0] - x[1]];
            let across = across - along.powi(2);
            let signal = |k: f64| 800.0 * across * (0.3 * k).sin() + 20.0 * along * (0.7 * k).cos();
            noise
                .enumerate()
                .map(|(k, (own, other))| signal(k as f64) + own + other)
                .collect()
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::zeros(COUNT, 2)
        }
    }

    #[test]
    fn clouds_along_principal_directions_follow_an_oblique_valley() {
        let go = &mut |_: &Progress| ControlFlow::Continue(());
        for seed in 0..5 {
            let valley = Valley(seed);
            let bounds = valley.bounds();
            let mut search = Search::new(&valley, &bounds, &[0.06, -0.05], 1e3).unwrap();
            let best = search.led(Axes::PrincipalDirections, go).unwrap();
            assert!(search.at.misfit() < 1.2, "{seed}: {}", search.at.misfit());
            let known = intervals_of(&search.at.x, &bounds, &best.covariance());
            for (x, [low, high]) in search.at.x.iter().zip(&known.intervals) {
                // The slope of 20 times a wave of mean square 1/2 along the valley, which both coordinates share.
                let textbook = 1.96 / (20.0 * (0.5 * COUNT as f64).sqrt());
                let ratio = (high - low) / textbook;
                assert!((0.9..2.5).contains(&ratio), "{seed}: {ratio}");
                assert!(low <= &0.0 && &0.0 <= high, "{seed}: {x} {low} {high}");
            }
        }
    }

    #[test]
    fn where_clouds_along_coordinates_end_far_others_lead_nearer() {
        let go = &mut |_: &Progress| ControlFlow::Continue(());
        for seed in 0..3 {
            let (valley, start) = (Valley(seed), [0.2, -0.15]);
            let bounds = valley.bounds();
            let mut first = Search::new(&valley, &bounds, &start, 1e3).unwrap();
            first.led(Axes::Coordinates, go).unwrap();
            let (found, _) = statistical_linearization(&valley, &start, 1e3, go).unwrap();
            let [first, found] = [first.at.misfit(), found.misfit()];
            assert!(
                first > 2.0 && found < 0.97 * first,
                "{seed}: {first} {found}"
            );
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
