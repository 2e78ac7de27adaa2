//! Where descents may start far away from the machine as it was given.
//!
//! Descents from where an amendment was screened find no way from one ringing to another. Energies by band and sector have few
//! minima, and clouds of points as wide as the whole ranges of what is unknown find their way to a low one. So all sets are
//! searched for a while, the better ones for longer (successive halving, Jamieson and Talwalkar 2016).

use crate::error::Error;
use crate::fitter::{Fitter, Start};
use crate::journal::Finished;
use calibrate::Problem;
use calibrate::cloud_descent::{CLOUDS, Descent, KEPT, Width, descend};
use calibrate::energies::Energies;
use calibrate::parameter::Parameter;
use calibrate::prior::{DESIGN, Prior, WithPriors};
use rayon::prelude::*;

/// How many times a third of the sets goes on; each time they are led on by as many clouds.
const STAGES: usize = 3;
/// Half the width of the first cloud along a coordinate of the machine, in standard deviations of what is known of it.
const SPREADS: f64 = 2.0;

/// The starts that were searched longest, the most promising first: their indices, and where their searches have ended. The first
/// `own` coordinates are the machine's.
///
/// # Errors
/// [`Error::Stopped`].
pub(crate) fn far_starts(
    fitter: &Fitter,
    starts: &[&Start],
    own: usize,
) -> Result<Vec<(usize, Vec<f64>)>, Error> {
    let effort = fitter.effort;
    let problems = starts.iter().map(|(problem, _)| problem);
    let fitted = problems.map(|problem| problem.with_runs(|run| effort.fits(&run.id)).metered());
    let fitted: Vec<_> = fitted.collect();
    let priors: Vec<Prior> = (0..own)
        .map(|place| Prior {
            place,
            spread: DESIGN,
        })
        .collect();
    let energies: Vec<Energies> = fitted.iter().map(Energies::new).collect();
    let compared = energies.iter().map(|inner| WithPriors {
        inner,
        priors: &priors,
    });
    let compared: Vec<_> = compared.collect();
    let mut searches: Vec<_> = compared
        .iter()
        .zip(starts)
        .enumerate()
        .map(|(index, (compared, (problem, x)))| Searched {
            index,
            descent: Descent::new(x, &widths(problem, own), compared),
            x: x.clone(),
            left: f64::INFINITY,
            steps: 0,
        })
        .collect();
    let all = searches.len();
    for round in 0..STAGES {
        if round > 0 && !effort.goes_on() {
            break;
        }
        let on = &mut searches[..all.div_ceil(KEPT.pow(round as u32))];
        let clouds = (round + 1) * CLOUDS / STAGES;
        let searched = on.par_iter_mut().map(|search| {
            let problem = &fitted[search.index];
            let input = ("far start", problem, &starts[search.index].1, own, clouds);
            let numbers = effort.journal.once(&input, || {
                // What earlier rounds found in the journal is searched again.
                while search.descent.clouds() < clouds {
                    let one = std::slice::from_mut(&mut search.descent);
                    let goes_on = descend(&compared[search.index], one, |_| {
                        (fitter.watch)().is_continue()
                    });
                    if !goes_on {
                        return Err(Error::Stopped);
                    }
                }
                let best = search.descent.best();
                let steps = problem.meter.steps();
                Ok(Finished {
                    numbers: [vec![best.left, steps as f64], best.x].concat(),
                    // The steps of its earlier rounds have been counted, those that were found in the journal as well.
                    cost: steps.saturating_sub(search.steps),
                })
            })?;
            if let [left, steps, x @ ..] = &numbers[..] {
                (search.left, search.steps) = (*left, *steps as u64);
                search.x = x.to_vec();
            }
            Ok(())
        });
        searched.collect::<Result<(), Error>>()?;
        on.sort_by(|a, b| a.left.total_cmp(&b.left));
    }
    searches.truncate(all.div_ceil(KEPT));
    let ends = searches.into_iter();
    Ok(ends.map(|search| (search.index, search.x)).collect())
}

/// A set that is searched.
struct Searched {
    /// The index of its start.
    index: usize,
    descent: Descent,
    /// The best point so far.
    x: Vec<f64>,
    /// The sum of squares there.
    left: f64,
    /// Steps of the integrator so far.
    steps: u64,
}

/// How wide the first cloud is along each coordinate: the whole range of what was added to the machine. What has none is held.
fn widths(problem: &Problem, own: usize) -> Vec<Width> {
    let width = |(place, parameter): (usize, &Parameter)| {
        let [low, high] = parameter.box_bounds();
        match place < own {
            true => (place, SPREADS * DESIGN),
            false => (place, 0.5 * (high - low)),
        }
    };
    let all = problem.parameters.iter().enumerate().map(width);
    all.filter(|(_, width)| *width > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::amendment::Amendment;
    use crate::effort::Effort;
    use crate::fixture::{effort, fitter, problem_of};
    use crate::hypothesis::start;
    use crate::journal::Journal;
    use serde_json::json;

    /// The sets of one amendment of these kinds, from their usual values.
    fn sets(problem: &Problem, kinds: [&str; 2]) -> Vec<Start> {
        let all = Amendment::all(problem).unwrap();
        let of = |kind: &str| {
            let one = all.iter().find(|one| one.kind() == kind).unwrap();
            let usual = one.effect().unwrap().usual();
            start(problem, &[0.0], one, &usual).unwrap()
        };
        kinds.map(of).into()
    }

    #[test]
    fn the_set_that_explains_comes_first_and_is_found_again_in_the_journal() {
        let hidden =
            json!([{"sensor_gain": {"measure": "crosshead_acceleration", "error": "40 %"}}]);
        let problem = problem_of(hidden);
        let sets = sets(&problem, ["extra_clearance", "sensor_gain"]);
        let starts: Vec<&Start> = sets.iter().collect();
        let path = std::env::temp_dir().join(format!("far-starts-{}", std::process::id()));
        let searched = || {
            let effort = Effort {
                journal: Journal::open(&path).unwrap(),
                ..effort()
            };
            let found = far_starts(&fitter(&effort), &starts, 1).unwrap();
            (found, effort.journal.spent())
        };
        let (found, spent) = searched();
        let [(1, x)] = &found[..] else {
            panic!("{found:?}");
        };
        let error = sets[1].0.parameters[1].value(x[1]);
        assert!((error - 0.4).abs() < 0.1, "{error}");
        assert!(spent > 0);
        // What is in the journal costs as much again.
        assert_eq!(searched(), (found.clone(), spent));
        std::fs::remove_file(&path).unwrap();
    }
}
