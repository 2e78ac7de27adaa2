//! Points from which a descent may lead to the true clearances.
//!
//! The clearance decides at which crank angle the joint's surfaces meet and everything rings. A descent finds no way
//! from one ringing to another, so that the clearances are screened on a grid, by energies, which have few minima.

use super::effort::Effort;
use super::joint::Joint;
use super::model::Model;
use crate::energies::Energies;
use crate::error::Error;
use crate::observation::Observation;
use crate::problem::Problem;

/// Step of the logarithm of a clearance. The time in which a gap is crossed goes with its root and changes by a tenth.
const STEP: f64 = 0.2;
/// Points that go on to the next joint.
const BEAM: usize = 4;
/// Points that are handed on.
const STARTS: usize = 48;
/// Distance of two of them at least, in logarithms of clearances.
const APART: f64 = 0.3;
/// Runs that are looked at.
const RUNS: usize = 3;

/// A point with its sum of squares, and the joints that have moved in it.
#[derive(Clone, Debug)]
struct Point {
    x: Vec<f64>,
    squares: f64,
    moved: Vec<usize>,
}

/// The best points around `x`, the best one first. One joint is moved over its grid, the best points are kept, and
/// another is moved, until every joint may have moved.
///
/// # Errors
/// A joint whose parameters are invalid.
pub(super) fn starts(
    model: &Model,
    joints: &[Joint],
    x: &[f64],
    effort: &mut Effort,
) -> Result<Vec<Vec<f64>>, Error> {
    let few = few(&model.problem);
    let energies = Energies::new(&few);
    let squares = |x: &[f64]| energies.squares(x).unwrap_or(f64::INFINITY);
    let mut all = vec![Point {
        x: x.to_vec(),
        squares: squares(x),
        moved: Vec::new(),
    }];
    let mut beam = all.clone();
    for _ in 0..model.clear.len() {
        let mut next: Vec<Point> = Vec::new();
        for point in &beam {
            for place in 0..model.clear.len() {
                if point.moved.contains(&place) {
                    continue;
                }
                let parameter = &model.problem.parameters[place];
                for clearance in grid(&joints[model.clear[place]]) {
                    let mut x = point.x.clone();
                    x[place] = parameter.coordinate(clearance);
                    // The same clearances are reached by moving the joints in another order.
                    if next.iter().any(|known| known.x == x) {
                        continue;
                    }
                    let moved = point.moved.iter().copied().chain([place]).collect();
                    let squares = squares(&x);
                    next.push(Point { x, squares, moved });
                    if !effort.evaluated() {
                        return Ok(vec![x_of_best(&all, &next)]);
                    }
                }
            }
        }
        next.sort_by(|a, b| a.squares.total_cmp(&b.squares));
        all.extend(next.iter().cloned());
        next.truncate(BEAM);
        beam = next;
    }
    all.sort_by(|a, b| a.squares.total_cmp(&b.squares));
    let mut starts: Vec<Vec<f64>> = Vec::new();
    for point in all {
        let near = |x: &Vec<f64>| x.iter().zip(&point.x).all(|(a, b)| (a - b).abs() < APART);
        if starts.len() < STARTS && !starts.iter().any(near) {
            starts.push(point.x);
        }
    }
    Ok(starts)
}

/// The best points with the clearance at `place`, that of `joint`, moved over its grid.
pub(super) fn along(
    model: &Model,
    joint: &Joint,
    place: usize,
    x: &[f64],
    effort: &mut Effort,
) -> Vec<Vec<f64>> {
    let few = few(&model.problem);
    let energies = Energies::new(&few);
    let mut points = Vec::new();
    for clearance in grid(joint) {
        let mut x = x.to_vec();
        x[place] = model.problem.parameters[place].coordinate(clearance);
        points.push((energies.squares(&x).unwrap_or(f64::INFINITY), x));
        if !effort.evaluated() {
            break;
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.truncate(BEAM);
    points.into_iter().map(|(_, x)| x).collect()
}

fn x_of_best(all: &[Point], next: &[Point]) -> Vec<f64> {
    let points = all.iter().chain(next);
    let best = points.min_by(|a, b| a.squares.total_cmp(&b.squares));
    best.map_or_else(Vec::new, |point| point.x.clone())
}

/// Clearances of equal ratio from where the search of a joint leads to the greatest, that itself left out.
fn grid(joint: &Joint) -> Vec<f64> {
    let [_, greatest] = joint.bounds;
    let from = match joint.stated {
        Some(stated) => stated,
        // What is ideal in the file is looked at from its normal clearance on.
        None => joint.normal * (-STEP).exp(),
    };
    let count = ((greatest / from).ln() / STEP).floor().max(1.0) as u32;
    let at = |i: u32| from * (STEP * f64::from(i)).exp();
    (1..=count).map(at).collect()
}

/// The problem with a few of its runs, of speeds as different as there are.
pub(super) fn few(problem: &Problem) -> Problem {
    let mut runs: Vec<&Observation> = problem.runs.iter().collect();
    runs.sort_by(|a, b| a.crank.speed.total_cmp(&b.crank.speed));
    let last = runs.len().saturating_sub(1);
    let chosen: Vec<String> = (0..RUNS)
        .filter_map(|i| runs.get(i * last / (RUNS - 1)))
        .map(|run| run.id.clone())
        .collect();
    problem.with_runs(|run| chosen.contains(&run.id))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_leads_from_the_stated_clearance_to_the_greatest() {
        let mut joint = Joint {
            path: String::new(),
            stated: Some(1e-4),
            normal: 1e-4,
            bounds: [3e-5, 1e-3],
        };
        let points = grid(&joint);
        assert_eq!(points.len(), 11);
        assert!(
            points.iter().all(|c| *c > 1.2e-4 && *c <= 1e-3),
            "{points:?}"
        );
        for pair in points.windows(2) {
            assert!(((pair[1] / pair[0]).ln() - STEP).abs() < 1e-12);
        }
        joint.stated = None;
        assert!((grid(&joint)[0] - 1e-4).abs() < 1e-18);
    }
}
