//! Whether recordings and machine can be of one another, before anything is fitted.

use crate::{Failure, bundle};
use ::calibrate::prediction::predict;
use ::calibrate::{Problem, Run};
use rayon::prelude::*;
use signal::order_lines::OrderLines;

/// Relative difference between stated and recorded speed that is a contradiction.
const SPEED: f64 = 0.02;
/// The first order of an acceleration is that of the crank's throw, whatever the contacts do: a
/// factor beyond this tells another stroke, speed or unit.
const FACTOR: f64 = 1.5;
/// A phase beyond this tells another zero of the crank angle, or a sensor the wrong way round, deg.
const PHASE: f64 = 45.0;
/// Share of a cylinder's pressures within which the greatest and least reach those that are stated.
const PRESSURE: f64 = 0.25;
/// Points over a revolution at which a mean is looked at.
const POINTS: usize = 360;

/// Refuses a run that turns at another speed than is stated.
///
/// # Errors
/// Where the two differ by more than 2 %.
pub fn speed(run: &Run, measured: f64) -> Result<(), Failure> {
    if (measured / run.speed_rpm - 1.0).abs() <= SPEED {
        return Ok(());
    }
    let error = ::calibrate::Error::Speed {
        run: run.id.clone(),
        stated: run.speed_rpm,
        measured,
    };
    Err(bundle::unusable(&run.id, &error.to_string()))
}

/// Holds every run against what the nominal machine shows.
///
/// # Errors
/// The first run that no parameters could bring together with the machine.
pub fn check(problem: &Problem) -> Result<(), Failure> {
    let nominal = vec![0.0; problem.parameters.len()];
    let predictions: Result<Vec<_>, _> = problem
        .runs
        .par_iter()
        .map(|run| predict(problem, run, &nominal))
        .collect();
    for (run, prediction) in problem
        .runs
        .iter()
        .zip(predictions.map_err(Failure::input)?)
    {
        for (observed, predicted) in run.channels.iter().zip(&prediction.lines) {
            let found = match observed.column.contains("crosshead_acceleration") {
                true => acceleration(&observed.lines, predicted),
                false if observed.column.contains("pressure") => {
                    pressure(&observed.lines, predicted)
                }
                false => None,
            };
            if let Some(reason) = found {
                let reason = format!("channel {}: {reason}", observed.column);
                return Err(bundle::unusable(&run.id, &reason));
            }
        }
    }
    Ok(())
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
