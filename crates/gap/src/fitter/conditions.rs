//! Under which speed, load and clearance a run was recorded.

use calibrate::observation::Observation;
use calibrate::{Error, Problem};

/// A condition that differs by less than this factor between the runs does not vary.
const VARIED: f64 = 1.1;
/// The index of the clearance among the conditions.
const CLEARANCE: usize = 2;

/// What a run was recorded under: speed, rad/s; load, the discharge less the suction pressure of all throws, Pa; clearance, of
/// all joints together, m.
pub(crate) type Conditions = [(&'static str, f64); 3];

/// Those of a run.
///
/// # Errors
/// An invalid machine.
pub(crate) fn conditions_of(
    problem: &Problem,
    run: &Observation,
    x: &[f64],
) -> Result<Conditions, Error> {
    let running = problem.machine(run, x)?;
    let machine = &running.machine;
    let load = |throw: &mechanism::Throw| throw.cylinder.discharge - throw.cylinder.suction;
    let clearance = |throw: &mechanism::Throw| {
        let joints = [&throw.big_end, &throw.small_end];
        let clear = joints.into_iter().filter_map(|joint| joint.clear());
        clear.map(|clear| clear.clearance).sum::<f64>()
    };
    let main = machine.main.clear().map_or(0.0, |clear| clear.clearance);
    let throws = &machine.throws;
    Ok([
        ("speed", running.speed.abs()),
        ("load", throws.iter().map(load).sum()),
        (
            "clearance",
            main + throws.iter().map(clearance).sum::<f64>(),
        ),
    ])
}

/// The indices of those conditions that vary between the runs.
pub(crate) fn varied(runs: &[Conditions]) -> Vec<usize> {
    let varies = |i: &usize| {
        let [least, greatest] = range(runs, *i);
        least > 0.0 && greatest > VARIED * least
    };
    (0..3).filter(varies).collect()
}

/// The indices of so many runs that differ from each other as much as possible, the first run first: each further one is
/// the one that is the furthest from all before (Gonzalez 1985). Logarithms of conditions count, over their range.
pub(crate) fn most_different(runs: &[Conditions], count: usize) -> Vec<usize> {
    let varied = varied(runs);
    let place = |run: &Conditions| -> Vec<f64> {
        let of = |i: &usize| {
            let [least, greatest] = range(runs, *i);
            (run[*i].1 / least).ln() / (greatest / least).ln()
        };
        varied.iter().map(of).collect()
    };
    let places: Vec<Vec<f64>> = runs.iter().map(place).collect();
    let distance = |i: usize, j: usize| -> f64 {
        let pairs = places[i].iter().zip(&places[j]);
        pairs.map(|(a, b)| (a - b).powi(2)).sum()
    };
    let mut chosen: Vec<usize> = (0..runs.len().min(1)).collect();
    while chosen.len() < count.min(runs.len()) {
        let nearest = |i: usize| {
            let distances = chosen.iter().map(|j| distance(i, *j));
            distances.fold(f64::INFINITY, f64::min)
        };
        let others = (0..runs.len()).filter(|i| !chosen.contains(i));
        // Of equals the first.
        let furthest = others
            .rev()
            .max_by(|i, j| nearest(*i).total_cmp(&nearest(*j)));
        chosen.extend(furthest);
    }
    chosen
}

/// The indices of those runs whose clearance is that of most of them, of equals the smaller one.
pub(crate) fn of_one_clearance(runs: &[Conditions]) -> Vec<usize> {
    let like = |one: &Conditions| -> Vec<usize> {
        let same = |i: &usize| {
            let [a, b] = [one[CLEARANCE].1, runs[*i][CLEARANCE].1];
            a.max(b) <= VARIED * a.min(b)
        };
        (0..runs.len()).filter(same).collect()
    };
    let mut all: Vec<&Conditions> = runs.iter().collect();
    all.sort_by(|a, b| a[CLEARANCE].1.total_cmp(&b[CLEARANCE].1));
    let of_each = all.into_iter().map(like);
    // Of equals the first.
    of_each.rev().max_by_key(Vec::len).unwrap_or_default()
}

fn range(runs: &[Conditions], condition: usize) -> [f64; 2] {
    let values = runs.iter().map(|run| run[condition].1);
    values.fold([f64::INFINITY, 0.0], |[least, greatest], value| {
        [value.min(least), value.max(greatest)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_differ_in_all_that_was_varied() {
        let run = |speed: f64, load: f64, clearance: f64| {
            [("speed", speed), ("load", load), ("clearance", clearance)]
        };
        let runs = [
            run(360.0, 3e5, 1e-4),
            run(510.0, 3e5, 1e-4),
            run(660.0, 3e5, 1e-4),
            run(360.0, 2e5, 1e-4),
            run(660.0, 2e5, 1e-4),
            run(510.0, 3e5, 2e-4),
        ];
        assert_eq!(most_different(&runs, 3), [0, 4, 5]);
        assert_eq!(most_different(&runs[..3], 3), [0, 2, 1]);
        assert_eq!(most_different(&runs[..1], 3), [0]);
        assert!(most_different(&[], 3).is_empty());
        assert_eq!(of_one_clearance(&runs), [0, 1, 2, 3, 4]);
        assert_eq!(of_one_clearance(&runs[4..]), [0]);
        assert!(of_one_clearance(&[]).is_empty());
        // Ideal joints have no clearance to differ in.
        let ideal = [run(360.0, 3e5, 0.0), run(361.0, 3e5, 0.0)];
        assert_eq!(most_different(&ideal, 1), [0]);
        assert!(varied(&ideal).is_empty());
        assert_eq!(of_one_clearance(&ideal), [0, 1]);
    }
}
