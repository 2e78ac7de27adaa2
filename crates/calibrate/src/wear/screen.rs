//! Points from which a descent may lead to the true clearances.
//!
//! The clearance decides at which crank angle the joint's surfaces meet and everything rings. A descent finds no way
//! from one ringing to another, so that the clearances are screened on a grid, by energies, which have few minima. The joints
//! of a throw act on each other: where two are wide, neither shows on a grid of the other alone. So they are moved together.
//! A joint that hardly shows changes energies less than a law somewhat off does, and lines by several times their noise. So
//! one joint more is screened by both.

use super::discrepancy::TIMINGS;
use super::effort::Effort;
use super::joint::Joint;
use super::model::Model;
use crate::energies::Energies;
use crate::likelihood::Likelihood;
use crate::observation::Observation;
use crate::problem::{Problem, throw};

/// Step of the logarithm of a clearance. The time in which a gap is crossed goes with its root and changes by a tenth.
pub(super) const STEP: f64 = 0.2;
/// The same where lines are compared, whose valleys are some hundredths of a clearance wide.
const STEP_OF_LINES: f64 = 0.05;
/// Steps of energies below the clearance of the machine file at which a grid begins: a joint may have less than is stated.
const BELOW: f64 = 2.0;
/// Joints that are moved together at most.
const TOGETHER: usize = 2;
/// Points that go on to the joints of the next throw.
const BEAM: usize = 4;
/// Runs that are looked at.
const RUNS: usize = 3;
/// Points of a grid that are looked at side by side, before the search may be stopped.
const GRID_AT_ONCE: usize = 64;
/// Descents before the search may be stopped.
pub(super) const AT_ONCE: usize = 16;

/// A point with what is left there, and the groups of joints that have moved in it.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// Coordinates.
    pub x: Vec<f64>,
    /// What is left of the energies, or of the lines.
    pub left: f64,
    moved: Vec<usize>,
}

/// The points of the grid around `x` with the relation between clearances that `x` has. The joints of a
/// group are moved over their common grid, the best points are kept, and another group is moved, until every joint may have moved.
pub(super) fn screened(
    model: &Model,
    joints: &[Joint],
    x: &[f64],
    effort: &mut Effort,
) -> Vec<Point> {
    let few = few(&model.problem);
    let energies = Energies::new(&few);
    let left = |points: &[Vec<f64>]| energies_left(&energies, points);
    let mut all = looked_at(left, vec![x.to_vec()], &[], effort);
    let mut beam = all.clone();
    let groups = groups(model);
    for _ in 0..groups.len() {
        let mut next: Vec<Point> = Vec::new();
        for point in &beam {
            for (i, group) in groups.iter().enumerate() {
                if point.moved.contains(&i) {
                    continue;
                }
                let mut places = product(model, joints, group, STEP, &point.x);
                // Nothing has moved, or the same clearances are reached by moving the groups in another order.
                places.retain(|x| *x != point.x && next.iter().all(|known| known.x != *x));
                let moved: Vec<usize> = point.moved.iter().copied().chain([i]).collect();
                next.extend(looked_at(left, places, &moved, effort));
            }
        }
        best_first(&mut next);
        all.extend(next.iter().cloned());
        next.truncate(BEAM);
        beam = next;
    }
    all
}

/// Points where one more joint is clear, by energies: those of these starts with the clearance at `place` moved over its grid,
/// and those of the best of them with the other joints moved over theirs, which were chosen without it.
pub(super) fn with_one_more(
    model: &Model,
    joints: &[Joint],
    place: usize,
    starts: &[Vec<f64>],
    effort: &mut Effort,
) -> Vec<Point> {
    let few = few(&model.problem);
    let energies = Energies::new(&few);
    let left = |points: &[Vec<f64>]| energies_left(&energies, points);
    let along = starts
        .iter()
        .flat_map(|x| product(model, joints, &[place], STEP, x));
    let mut points = looked_at(left, along.collect(), &[], effort);
    best_first(&mut points);
    let Some(best) = points.first().map(|point| point.x.clone()) else {
        return points;
    };
    for mut group in groups(model) {
        group.retain(|other| *other != place);
        let mut places = product(model, joints, &group, STEP, &best);
        places.retain(|x| *x != best);
        points.extend(looked_at(left, places, &[], effort));
    }
    points
}

/// Points where one more joint is clear, by lines: those of these starts with the clearance at `place` moved over a fine grid.
pub(super) fn by_lines(
    model: &Model,
    joints: &[Joint],
    place: usize,
    starts: &[Vec<f64>],
    effort: &mut Effort,
) -> Vec<Point> {
    let few = few(&model.problem);
    let lines = Likelihood::new(&few);
    let left = |points: &[Vec<f64>]| {
        let all = lines.likeliest_of_all(points, &TIMINGS).into_iter();
        all.map(|found| found.map_or(f64::INFINITY, |(_, left)| left))
            .collect()
    };
    let along = |x: &Vec<f64>| product(model, joints, &[place], STEP_OF_LINES, x);
    looked_at(left, starts.iter().flat_map(along).collect(), &[], effort)
}

fn best_first(points: &mut [Point]) {
    points.sort_by(|a, b| a.left.total_cmp(&b.left));
}

/// The best of these points, which are taken out.
pub(super) fn best_of(points: &mut Vec<Point>, count: usize) -> Vec<Vec<f64>> {
    best_first(points);
    let best = points.drain(..points.len().min(count));
    best.map(|point| point.x).collect()
}

/// Places of clearances that are moved together: those of one throw, a few at a time.
fn groups(model: &Model) -> Vec<Vec<usize>> {
    let throw_of = |place: usize| throw(&model.problem.parameters[place].path);
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for place in 0..model.clear.len() {
        let open = |group: &&mut Vec<usize>| {
            group.len() < TOGETHER && throw_of(group[0]) == throw_of(place)
        };
        match groups.iter_mut().find(open) {
            Some(group) => group.push(place),
            None => groups.push(vec![place]),
        }
    }
    groups
}

/// The point `x` with the clearances of a group at all points of their common grid.
fn product(
    model: &Model,
    joints: &[Joint],
    group: &[usize],
    step: f64,
    x: &[f64],
) -> Vec<Vec<f64>> {
    let mut points = vec![x.to_vec()];
    for place in group {
        let parameter = &model.problem.parameters[*place];
        let grid = grid(&joints[model.clear[*place]], step);
        let moved = points.iter().flat_map(|x| {
            grid.iter().map(|clearance| {
                let mut x = x.clone();
                x[*place] = parameter.coordinate(*clearance);
                x
            })
        });
        points = moved.collect();
    }
    points
}

fn energies_left(energies: &Energies, points: &[Vec<f64>]) -> Vec<f64> {
    let all = energies.squares_of_all(points).into_iter();
    all.map(|left| left.unwrap_or(f64::INFINITY)).collect()
}

/// These points with what is `left` there, infinite where a run cannot be simulated; those before a stop.
fn looked_at(
    left: impl Fn(&[Vec<f64>]) -> Vec<f64>,
    points: Vec<Vec<f64>>,
    moved: &[usize],
    effort: &mut Effort,
) -> Vec<Point> {
    let mut all = Vec::new();
    for part in points.chunks(GRID_AT_ONCE) {
        if effort.stopped {
            break;
        }
        all.extend(part.iter().zip(left(part)).map(|(x, left)| Point {
            x: x.clone(),
            left,
            moved: moved.to_vec(),
        }));
        effort.evaluated(part.len() as u64);
    }
    all
}

/// Clearances of equal ratio around that from which the search of a joint leads, from some below it to the greatest.
fn grid(joint: &Joint, step: f64) -> Vec<f64> {
    let [least, greatest] = joint.bounds;
    let steps = |to: f64| ((to / joint.start()).ln() / step).floor() as i32;
    let below = (BELOW * STEP / step).round() as i32;
    let first = steps(least).max(-below);
    let at = |i: i32| joint.start() * (step * f64::from(i)).exp();
    let all = (first..=steps(greatest).max(1)).map(at);
    all.filter(|c| (least..=greatest).contains(c)).collect()
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
    fn a_grid_leads_from_below_the_stated_clearance_to_the_greatest() {
        let mut joint = Joint {
            path: String::new(),
            stated: Some(1e-4),
            normal: 1e-4,
            bounds: [3e-5, 1e-3],
        };
        let points = grid(&joint, STEP);
        // ln 10 / 0.2 = 11.5: eleven steps up, two down and the stated clearance itself.
        assert_eq!(points.len(), 14);
        assert!((points[2] - 1e-4).abs() < 1e-18, "{points:?}");
        assert!((points[0] / 1e-4 - (-0.4_f64).exp()).abs() < 1e-12);
        for pair in points.windows(2) {
            assert!(((pair[1] / pair[0]).ln() - STEP).abs() < 1e-12);
        }
        joint.stated = None;
        joint.bounds = [0.9e-4, 1.1e-4];
        assert_eq!(grid(&joint, STEP), [1e-4]);
    }
}
