//! Where descents may start far away from the machine as it was given.
//!
//! Descents from where an amendment was screened find no way from one ringing to another. Energies by band and sector have few
//! minima where what is quieter than the noise of a revolution does not count, and within the whole ranges of what is unknown CMA-ES
//! finds its way to a low one, which takes some hundred evaluations for each coordinate. So all sets are searched for a while, the
//! better ones for longer: each round costs the same (successive halving, Jamieson and Talwalkar 2016).

use crate::error::Error;
use crate::fitter::Fitter;
use crate::fitter::effort::FAR_ROUND;
use crate::fitter::journal::Finished;
use calibrate::Problem;
use calibrate::cloud_descent::KEPT;
use calibrate::energies::Energies;
use calibrate::parameter::Parameter;
use calibrate::prior::{DESIGN, Prior, WithPriors};
use calibrate::region::{Region, SPREADS};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Rounds of a search.
const FAR_ROUNDS: u32 = 4;
/// Share of its range within which a coordinate is followed that was searched before.
const FOLLOWED: f64 = 0.25;

/// A set, and from where it is searched.
pub(crate) struct FarStart<'a> {
    pub problem: &'a Problem,
    pub x: Vec<f64>,
    /// How many of the first coordinates were searched before.
    pub followed: usize,
}

/// The starts, those that were searched longest first and the most promising of these before others: their indices, and where their
/// searches have ended. The first `own` coordinates are the machine's.
///
/// # Errors
/// [`Error::Stopped`].
pub(crate) fn far_starts(
    fitter: &Fitter,
    starts: &[FarStart],
    own: usize,
) -> Result<Vec<(usize, Vec<f64>)>, Error> {
    let effort = fitter.effort;
    let problems = starts.iter().map(|start| start.problem);
    let fitted = problems.map(|problem| problem.with_runs(|run| effort.fits(&run.id)).metered());
    let fitted: Vec<_> = fitted.collect();
    let priors: Vec<Prior> = (0..own)
        .map(|place| Prior {
            place,
            spread: DESIGN,
        })
        .collect();
    let energies: Vec<Energies> = fitted.iter().map(Energies::loud).collect();
    let compared = energies.iter().map(|inner| WithPriors {
        inner,
        priors: &priors,
    });
    let compared: Vec<_> = compared.collect();
    let mut searches: Vec<_> = compared
        .iter()
        .zip(starts)
        .enumerate()
        .map(|(index, (compared, start))| Searched {
            index,
            region: Region::new(compared, &start.x, &ranges(start, own)),
            x: start.x.clone(),
            left: f64::INFINITY,
            steps: 0,
        })
        .collect();
    let all = searches.len();
    let mut most = 0;
    for round in 0..FAR_ROUNDS {
        if round > 0 && !effort.goes_on() {
            break;
        }
        let on = &mut searches[..all.div_ceil(KEPT.pow(round))];
        most += FAR_ROUND / on.len().max(1) as u64;
        let searched = on.par_iter_mut().map(|search| {
            let problem = &fitted[search.index];
            let FarStart { x, followed, .. } = &starts[search.index];
            let input = ("far start", problem, x, followed, own, most);
            let numbers = effort.journal.once(&input, || {
                let within = || match problem.meter.steps() < most {
                    true => (fitter.watch)(),
                    false => ControlFlow::Break(()),
                };
                let found = search.region.searched(u64::MAX, &mut |_| within());
                if (fitter.watch)().is_break() {
                    return Err(Error::Stopped);
                }
                let steps = problem.meter.steps();
                // A search that cannot begin leaves everything.
                let numbers = found.map_or_else(
                    |_| Vec::new(),
                    |found| [vec![found.cost, steps as f64], found.x].concat(),
                );
                Ok(Finished {
                    numbers,
                    // The steps of its earlier rounds have been counted, those that were found in the journal as well.
                    cost: steps.saturating_sub(search.steps),
                })
            })?;
            if let [left, steps, moved @ ..] = &numbers[..] {
                (search.left, search.steps) = (*left, *steps as u64);
                search.x = search.region.whole(moved);
            }
            Ok(())
        });
        searched.collect::<Result<(), Error>>()?;
        on.sort_by(|a, b| a.left.total_cmp(&b.left));
    }
    let ends = searches.into_iter();
    Ok(ends.map(|search| (search.index, search.x)).collect())
}

/// A set that is searched.
struct Searched<'a, T> {
    /// The index of its start.
    index: usize,
    region: Region<'a, T>,
    /// The best point so far.
    x: Vec<f64>,
    /// Half the sum of squares there.
    left: f64,
    /// Steps of the integrator so far.
    steps: u64,
}

/// The coordinates of a set with their ranges: the whole ones of what was added to the machine, and a part of what is followed.
fn ranges(start: &FarStart, own: usize) -> Vec<(usize, [f64; 2])> {
    let half = SPREADS * DESIGN;
    let range = |(place, parameter): (usize, &Parameter)| {
        let [low, high] = match place < own {
            true => [-half, half],
            false => parameter.box_bounds(),
        };
        if place >= start.followed {
            return (place, [low, high]);
        }
        let near = 0.5 * FOLLOWED * (high - low);
        let x = start.x[place];
        (place, [low.max(x - near), high.min(x + near)])
    };
    let parameters = start.problem.parameters.iter();
    parameters.enumerate().map(range).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::amendment::Amendment;
    use crate::fitter::Start;
    use crate::fitter::effort::Effort;
    use crate::fitter::journal::Journal;
    use crate::fixture::{effort, fitter, problem_of};
    use crate::search::hypothesis::start;
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

    fn from(sets: &[Start], followed: usize) -> Vec<FarStart<'_>> {
        let sets = sets.iter();
        let from = sets.map(|(problem, x)| FarStart {
            problem,
            x: x.clone(),
            followed,
        });
        from.collect()
    }

    #[test]
    fn what_was_searched_before_is_followed_nearby_within_its_bounds() {
        let problem = problem_of(json!([]));
        let sets = sets(&problem, ["extra_clearance", "sensor_gain"]);
        let ranges = |x: f64, followed: usize| {
            let mut start = from(&sets, followed).swap_remove(1);
            start.x[0] = x;
            let of_each = ranges(&start, 1).into_iter();
            let of_each: Vec<[f64; 2]> = of_each.map(|(_, range)| range).collect();
            of_each
        };
        let whole = ranges(0.1, 0);
        assert_eq!(whole[0], [-0.6, 0.6]);
        let followed = ranges(0.1, 1);
        let near = [0.1 - 0.15, 0.1 + 0.15];
        for (bound, expected) in followed[0].into_iter().zip(near) {
            assert!((bound - expected).abs() < 1e-12, "{bound} {expected}");
        }
        assert_eq!(followed[1], whole[1]);
        assert_eq!(ranges(0.6, 1)[0][1], 0.6);
    }

    #[test]
    fn the_set_that_explains_comes_first_and_is_found_again_in_the_journal() {
        let hidden =
            json!([{"sensor_gain": {"measure": "crosshead_acceleration", "error": "40 %"}}]);
        let problem = problem_of(hidden);
        let sets = sets(&problem, ["extra_clearance", "sensor_gain"]);
        let starts = from(&sets, 0);
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
        let [(1, x), (0, _)] = &found[..] else {
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
