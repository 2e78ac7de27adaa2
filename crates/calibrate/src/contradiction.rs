//! Whether recordings and machine can be of one another, before anything is fitted.

use crate::error::Error;
use crate::observation::Run;
use crate::observation::SPEED;
use crate::prediction::{Prediction, predict};
use crate::problem::Problem;
use rayon::prelude::*;
use signal::order_lines::OrderLines;

/// The first order of an acceleration is that of the crank's throw; the contacts hardly change it. A factor
/// beyond this means another stroke, speed or unit.
const FACTOR: f64 = 1.5;
/// A phase beyond this means another zero of the crank angle, or a sensor the wrong way round, deg.
const PHASE: f64 = 45.0;
/// Share of a cylinder's pressures within which the greatest and least reach those that are stated.
const PRESSURE: f64 = 0.25;
/// Relative difference of two runs' pressures from which their order counts. Valve losses, which grow with the
/// speed, raise the greatest pressure of a run by up to a fifth. Two runs have to differ by as much in all.
const ORDER: f64 = 0.1;
/// Points over a revolution at which a mean is looked at.
const POINTS: usize = 360;

/// Refuses a run that turns at another speed than is stated.
///
/// # Errors
/// Where the two differ by more than 2 %.
pub fn speed(run: &Run, measured: f64) -> Result<(), Error> {
    if (measured / run.speed_rpm - 1.0).abs() <= SPEED {
        return Ok(());
    }
    let error = Error::Speed {
        run: run.id.clone(),
        stated: run.speed_rpm,
        measured,
    };
    Err(Error::unusable(&run.id, error))
}

/// Holds every run against what the machine shows at the coordinates `x`.
///
/// # Errors
/// The first run that no parameters could bring together with the machine, or two that seem to be each other.
pub fn check(problem: &Problem, x: &[f64]) -> Result<(), Error> {
    let predictions = predictions(problem, x)?;
    for (run, prediction) in problem.runs.iter().zip(&predictions) {
        for (observed, predicted) in run.channels.iter().zip(&prediction.lines) {
            let found = match observed.column.contains("crosshead_acceleration") {
                true => acceleration(&observed.lines, predicted),
                false if observed.quantity().is_pressure() => pressure(&observed.lines, predicted),
                false => None,
            };
            if let Some(reason) = found {
                let reason = format!("channel {}: {reason}", observed.column);
                return Err(Error::unusable(&run.id, reason));
            }
        }
    }
    swapped(problem, &predictions)
}

/// What the machine shows of every run.
///
/// # Errors
/// A machine that cannot be simulated.
fn predictions(problem: &Problem, x: &[f64]) -> Result<Vec<Prediction>, Error> {
    let runs = problem.runs.par_iter();
    runs.map(|run| predict(problem, run, x)).collect()
}

/// Refuses two runs of which each has recorded the load that is stated for the other.
fn swapped(problem: &Problem, predictions: &[Prediction]) -> Result<(), Error> {
    let runs = problem.runs.iter().zip(predictions);
    let mut seen: Vec<(&str, &str, [f64; 2], [f64; 2])> = Vec::new();
    for (run, prediction) in runs {
        for (observed, predicted) in run.channels.iter().zip(&prediction.lines) {
            if !observed.quantity().is_pressure() {
                continue;
            }
            let [recorded, stated] = [&observed.lines, predicted].map(extremes);
            let column = observed.column.as_str();
            for (other, _, other_recorded, other_stated) in
                seen.iter().filter(|(_, other, ..)| *other == column)
            {
                for (i, which) in [(1, "greatest"), (0, "least")] {
                    let [shown, given] = [
                        [recorded[i], other_recorded[i]],
                        [stated[i], other_stated[i]],
                    ];
                    if are_opposed(shown, given) {
                        let reason = format!(
                            "channel {column}: its {which} value is {:.4} Pa and that of run {other} is {:.4} Pa, but \
                             their loads are stated the other way round, as {:.4} Pa and {:.4} Pa: are the two \
                             recordings or their loads swapped?",
                            shown[0], shown[1], given[0], given[1]
                        );
                        return Err(Error::unusable(&run.id, reason));
                    }
                }
            }
            seen.push((&run.id, column, recorded, stated));
        }
    }
    Ok(())
}

/// Whether the one pair clearly rises where the other clearly falls.
fn are_opposed(a: [f64; 2], b: [f64; 2]) -> bool {
    let rise = |[from, to]: [f64; 2]| match from > 0.0 && to > 0.0 {
        true => (to / from).ln(),
        false => 0.0,
    };
    let [a, b] = [rise(a), rise(b)];
    a.abs() > ORDER && b.abs() > ORDER && (a > 0.0) != (b > 0.0)
}

fn acceleration(observed: &OrderLines, predicted: &OrderLines) -> Option<String> {
    let [recorded, machine] = [observed, predicted].map(|lines| lines.amplitude[1]);
    let factor = recorded.norm() / machine.norm();
    if !(1.0 / FACTOR..=FACTOR).contains(&factor) {
        return Some(format!(
            "its first order is {:.4} m/s², and stroke and speed of the machine give {:.4} m/s²: \
             check its unit, crank_radius_m and speed_rpm",
            recorded.norm(),
            machine.norm()
        ));
    }
    let apart = (recorded / machine).arg().to_degrees();
    (apart.abs() > PHASE).then(|| {
        format!(
            "its first order leads that of the machine by {apart:.0} deg: check that the crank angle \
             is 0 at top dead centre and that acceleration is positive toward the head"
        )
    })
}

fn pressure(observed: &OrderLines, predicted: &OrderLines) -> Option<String> {
    let [recorded, machine] = [observed, predicted].map(extremes);
    let [least, greatest] = recorded;
    let reason = if greatest < (1.0 - PRESSURE) * machine[1] {
        format!(
            "its greatest value is {greatest:.4} Pa and never reaches the discharge pressure, {:.4} Pa",
            machine[1]
        )
    } else if least > (1.0 + PRESSURE) * machine[0] {
        format!(
            "its least value is {least:.4} Pa and never reaches the suction pressure, {:.4} Pa",
            machine[0]
        )
    } else {
        return None;
    };
    Some(format!(
        "{reason}: check its unit and the run's load, which are absolute"
    ))
}

/// Least and greatest value of a synchronous mean, from its first orders.
fn extremes(lines: &OrderLines) -> [f64; 2] {
    let values = (0..POINTS).map(|i| {
        let angle = std::f64::consts::TAU * i as f64 / POINTS as f64;
        let terms = lines.amplitude.iter().take(POINTS / 4).enumerate();
        let value = terms.map(|(k, c)| {
            let (sin, cos) = (k as f64 * angle).sin_cos();
            c.re * cos - c.im * sin
        });
        value.sum::<f64>()
    });
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_opposed_where_both_differ_clearly() {
        assert!(are_opposed([3.0, 3.9], [3.9, 3.0]));
        assert!(!are_opposed([3.0, 3.9], [3.0, 3.9]));
        // Losses of valves at another speed.
        assert!(!are_opposed([3.0, 3.2], [3.2, 3.0]));
        assert!(!are_opposed([3.0, 3.0], [3.9, 3.0]) && !are_opposed([-1.0, 3.0], [3.0, 1.0]));
    }
}
