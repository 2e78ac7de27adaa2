//! As few vertices as the pixels need.
//!
//! All functions work in pixels and keep the order of the points.

/// Largest distance in pixels between a line as recorded and as drawn.
const TOLERANCE: f64 = 0.1;
/// Most separate points of one series.
const MOST_POINTS: usize = 4_000;

/// At most `most` vertices of a line that shows the same as the line through all points. Where more
/// are needed the tolerance is doubled until they are not.
pub(super) fn line(points: &[[f64; 2]], most: usize) -> Vec<[f64; 2]> {
    let mut kept = if points.is_sorted_by(|a, b| a[0] <= b[0]) {
        column_extremes(points)
    } else {
        points.to_vec()
    };
    let mut tolerance = TOLERANCE;
    kept = within(&kept, tolerance);
    while kept.len() > most.max(2) {
        tolerance *= 2.0;
        kept = within(&kept, tolerance);
    }
    kept
}

/// The first, lowest, highest and last point of every pixel column, for points of rising x.
///
/// The drawn line covers the same pixels as the full one (U. Jugel et al., "M4: a
/// visualization-oriented time series data aggregation", VLDB 2014).
pub(super) fn column_extremes(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept = Vec::new();
    for column in points.chunk_by(|a, b| a[0].floor() == b[0].floor()) {
        let (mut lowest, mut highest) = (0, 0);
        for (i, point) in column.iter().enumerate() {
            if point[1] < column[lowest][1] {
                lowest = i;
            }
            if point[1] > column[highest][1] {
                highest = i;
            }
        }
        let mut picks = [
            0,
            lowest.min(highest),
            lowest.max(highest),
            column.len() - 1,
        ]
        .to_vec();
        picks.dedup();
        kept.extend(picks.into_iter().map(|i| column[i]));
    }
    kept
}

/// A subset of the vertices whose line passes every other vertex within the tolerance.
///
/// From an anchor, the directions that pass all points seen so far are an interval of angles
/// that each point narrows. The point before the first one outside it is the next anchor. A point
/// that comes back towards the anchor also ends the stretch, so that no turning point is lost.
pub(super) fn within(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
        return Vec::new();
    };
    let mut kept = vec![first];
    let (mut anchor, mut previous) = (first, first);
    let mut cone: Option<Cone> = None;
    for &point in &points[1..] {
        let seen = cone.as_ref().is_none_or(|cone| cone.passes(anchor, point));
        if !seen {
            kept.push(previous);
            anchor = previous;
            cone = None;
        }
        if distance(anchor, point) > tolerance {
            cone = Some(Cone::narrowed(cone, anchor, point, tolerance));
        }
        previous = point;
    }
    if points.len() > 1 {
        kept.push(last);
    }
    kept
}

/// The directions from the anchor, as angles from `axis`, that pass all points so far.
struct Cone {
    axis: f64,
    low: f64,
    high: f64,
    reach: f64,
}

impl Cone {
    fn narrowed(cone: Option<Self>, anchor: [f64; 2], point: [f64; 2], tolerance: f64) -> Self {
        let reach = distance(anchor, point);
        let half = (tolerance / reach).asin();
        match cone {
            None => Self {
                axis: direction(anchor, point),
                low: -half,
                high: half,
                reach,
            },
            Some(cone) => {
                let angle = turn(direction(anchor, point) - cone.axis);
                Self {
                    axis: cone.axis,
                    low: cone.low.max(angle - half),
                    high: cone.high.min(angle + half),
                    reach: cone.reach.max(reach),
                }
            }
        }
    }

    fn passes(&self, anchor: [f64; 2], point: [f64; 2]) -> bool {
        let reach = distance(anchor, point);
        let angle = turn(direction(anchor, point) - self.axis);
        reach >= self.reach && (self.low..=self.high).contains(&angle)
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

fn direction(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[1] - a[1]).atan2(b[0] - a[0])
}

fn turn(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    (angle + PI).rem_euclid(TAU) - PI
}

/// At most [`MOST_POINTS`] of the points, spread evenly over the sequence; the outermost stay.
pub(super) fn points(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() <= MOST_POINTS {
        return points.to_vec();
    }
    let outermost = outermost(points);
    let stride = points.len().div_ceil(MOST_POINTS - outermost.len());
    let spread = |i: &usize| i.is_multiple_of(stride) || outermost.contains(i);
    (0..points.len())
        .filter(spread)
        .map(|i| points[i])
        .collect()
}

/// Most dots of one series.
const MOST_DOTS: usize = 12_000;

/// The points without those that fall on the same half pixel as another, from left to right and
/// upwards; of more than [`MOST_DOTS`] only every second, third, …
pub(super) fn dots(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut halves: Vec<[i64; 2]> = points
        .iter()
        .map(|point| point.map(|v| (2.0 * v).round() as i64))
        .collect();
    halves.sort_unstable();
    halves.dedup();
    let stride = halves.len().div_ceil(MOST_DOTS).max(1);
    let kept = halves.into_iter().step_by(stride);
    kept.map(|half| half.map(|v| v as f64 / 2.0)).collect()
}

/// The places of the points that are furthest left, right, down and up.
fn outermost(points: &[[f64; 2]]) -> [usize; 4] {
    let furthest = |coordinate: usize, sign: f64| {
        (0..points.len()).fold(0, |best, i| {
            if sign * points[i][coordinate] > sign * points[best][coordinate] {
                i
            } else {
                best
            }
        })
    };
    [
        furthest(0, -1.0),
        furthest(0, 1.0),
        furthest(1, -1.0),
        furthest(1, 1.0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ringing curve with a spike that lasts one sample, 20 000 points over 600 pixels.
    fn ringing() -> Vec<[f64; 2]> {
        (0..20_000)
            .map(|i| {
                let x = f64::from(i) * 0.03;
                let spike = if i == 12_345 { 500.0 } else { 0.0 };
                [x, 100.0 * (x * 0.7).sin() * (-x / 200.0).exp() + spike]
            })
            .collect()
    }

    fn extremes(points: &[[f64; 2]]) -> (f64, f64) {
        points.iter().fold((f64::MAX, f64::MIN), |(low, high), p| {
            (low.min(p[1]), high.max(p[1]))
        })
    }

    /// Distance of a point from a polyline.
    fn gap(point: [f64; 2], line: &[[f64; 2]]) -> f64 {
        line.windows(2)
            .map(|ends| {
                let along = [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]];
                let length = along[0].powi(2) + along[1].powi(2);
                let to = [point[0] - ends[0][0], point[1] - ends[0][1]];
                let at =
                    ((to[0] * along[0] + to[1] * along[1]) / length.max(1e-300)).clamp(0.0, 1.0);
                (to[0] - at * along[0]).hypot(to[1] - at * along[1])
            })
            .fold(f64::MAX, f64::min)
    }

    #[test]
    fn every_pixel_column_keeps_its_extremes() {
        let full = ringing();
        let kept = column_extremes(&full);
        assert!(kept.len() <= 4 * 601, "{} vertices", kept.len());
        let column = |points: &[[f64; 2]], x: f64| {
            extremes(
                &points
                    .iter()
                    .copied()
                    .filter(|p| p[0].floor() == x)
                    .collect::<Vec<_>>(),
            )
        };
        for x in 0..600 {
            assert_eq!(
                column(&full, f64::from(x)),
                column(&kept, f64::from(x)),
                "column {x}"
            );
        }
    }

    #[test]
    fn a_thinned_line_passes_every_point_within_the_tolerance() {
        // A spiral that is run back on itself: x is not monotonic and the way turns round.
        let out: Vec<[f64; 2]> = (0..3_000)
            .map(|i| {
                let t = f64::from(i) * 0.01;
                [10.0 * t * t.cos(), 10.0 * t * t.sin()]
            })
            .collect();
        let full: Vec<[f64; 2]> = out.iter().chain(out.iter().rev()).copied().collect();
        let kept = within(&full, 0.1);
        assert!(
            kept.len() < full.len() / 3,
            "{} of {} vertices",
            kept.len(),
            full.len()
        );
        for &point in &full {
            assert!(
                gap(point, &kept) <= 0.1 + 1e-9,
                "{point:?} is {} off",
                gap(point, &kept)
            );
        }
    }

    #[test]
    fn a_line_that_runs_there_and_back_keeps_its_turning_point() {
        let kept = within(
            &[[0.0, 0.0], [5.0, 0.0], [10.0, 0.0], [4.0, 0.0], [1.0, 0.0]],
            0.1,
        );
        assert_eq!(kept, [[0.0, 0.0], [10.0, 0.0], [1.0, 0.0]]);
    }

    #[test]
    fn long_lines_and_clouds_are_bounded_and_keep_their_extent() {
        // A cloud from a linear congruential generator, as a line the worst case there is.
        let mut state = 1_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 * 300.0
        };
        let cloud: Vec<[f64; 2]> = (0..50_000).map(|_| [next(), next()]).collect();
        assert!(line(&cloud, 3_000).len() <= 3_000);
        let kept = points(&cloud);
        assert!(kept.len() <= MOST_POINTS);
        assert_eq!(extremes(&kept), extremes(&cloud));
        assert!(line(&[], 0).is_empty() && points(&[]).is_empty());
        assert!(dots(&cloud).len() <= MOST_DOTS && dots(&[]).is_empty());
        let same = [[1.0, 2.0], [1.1, 2.1], [0.0, 7.0]];
        assert_eq!(dots(&same), [[0.0, 7.0], [1.0, 2.0]]);
    }
}
