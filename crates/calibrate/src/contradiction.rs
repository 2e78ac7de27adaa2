//! Whether recordings and machine can be of one another, before anything is fitted.

use crate::error::Error;
use crate::observation::Run;
use crate::observation::SPEED;
use crate::prediction::{Prediction, predict};
use crate::pressure_range::{Recorded, shut_valves};
use crate::problem::Problem;
use crate::shut_valve::ShutValve;
use rayon::prelude::*;
use signal::Complex64;
use signal::order_lines::OrderLines;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The first order of an acceleration is that of the crank's throw; the contacts hardly change it. A factor
/// beyond this means another stroke, speed or unit.
const FACTOR: f64 = 1.5;
/// A phase beyond this means another zero of the crank angle, or a sensor the wrong way round, deg.
const PHASE: f64 = 45.0;
/// Relative difference of two runs' pressures from which their order counts. Valve losses, which grow with the
/// speed, raise the greatest pressure of a run by up to a fifth. Two runs have to differ by as much in all.
const ORDER: f64 = 0.1;
/// Share of its range within which the mean of a pressure counts as 0: its sensor passes no slow changes. Absolute and gauge
/// pressures lie on one side of 0.
const NO_MEAN: f64 = 0.02;
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

/// Refuses a pressure that has no mean, where the machine does not state the high pass of its sensor: what it shows would be fitted
/// as it is to an absolute pressure.
///
/// # Errors
/// The first channel that is so; an invalid machine.
pub fn refuse_without_mean(problem: &Problem, x: &[f64]) -> Result<(), Error> {
    for run in &problem.runs {
        let sensors = problem.machine(run, x)?.sensors;
        for (observed, sensor) in run.channels.iter().zip(&sensors) {
            let has_high_pass = sensor.chain.high_pass.is_some();
            if observed.quantity().is_pressure() && !has_high_pass && !has_mean(&observed.lines) {
                let reason = format!(
                    "channel {}: its mean is 0, so that its sensor passes no slow changes: state its `high_pass` in the \
                     machine file, or find it with crosshead explain-gap",
                    observed.column
                );
                return Err(Error::unusable(&run.id, reason));
            }
        }
    }
    Ok(())
}

/// Holds every run against what the machine shows at the coordinates `x`, and returns the valves that stay shut.
///
/// # Errors
/// The first run that no parameters could bring together with the machine, or two that seem to be each other.
pub fn check(problem: &Problem, x: &[f64]) -> Result<Vec<ShutValve>, Error> {
    let predictions = predictions(problem, x)?;
    let mut shut = Vec::new();
    for (run, prediction) in problem.runs.iter().zip(&predictions) {
        let machine = problem.machine(run, x)?;
        let offset = problem.crank_angle_offset(run, x).0;
        for (observed, predicted) in run.channels.iter().zip(&prediction.lines) {
            let of_channel = |reason: String| {
                Error::unusable(&run.id, format!("channel {}: {reason}", observed.column))
            };
            if observed.column.contains("crosshead_acceleration") {
                acceleration(&observed.lines, predicted).map_err(of_channel)?;
            } else if observed.quantity().is_pressure() && has_mean(&observed.lines) {
                pressure(&observed.lines, predicted).map_err(of_channel)?;
                let recorded = recorded(&observed.lines, offset, machine.speed >= 0.0);
                let valves = shut_valves(&machine.machine, &observed.column, &recorded);
                let valves = valves.map_err(of_channel)?.into_iter();
                shut.extend(valves.map(|(valve, [reached_pa, stated_pa])| ShutValve {
                    run: run.id.clone(),
                    channel: observed.column.clone(),
                    valve,
                    reached_pa,
                    stated_pa,
                }));
            }
        }
    }
    swapped(problem, &predictions)?;
    Ok(shut)
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

fn acceleration(observed: &OrderLines, predicted: &OrderLines) -> Result<(), String> {
    let [recorded, machine] = [observed, predicted].map(|lines| lines.amplitude[1]);
    if is_high_passed(recorded / machine) {
        return Ok(());
    }
    let factor = recorded.norm() / machine.norm();
    if !(1.0 / FACTOR..=FACTOR).contains(&factor) {
        return Err(format!(
            "its first order is {:.4} m/s², and stroke and speed of the machine give {:.4} m/s²: \
             check its unit, crank_radius_m and speed_rpm",
            recorded.norm(),
            machine.norm()
        ));
    }
    let apart = (recorded / machine).arg().to_degrees();
    match apart.abs() > PHASE {
        true => Err(format!(
            "its first order leads that of the machine by {apart:.0} deg: check that the crank angle \
             is 0 at top dead centre and that acceleration is positive toward the head"
        )),
        false => Ok(()),
    }
}

/// A pressure that falls while its end of the cylinder gets smaller is that of the other end: its first order is opposite. A valve
/// that stays open leaves little of the first order, and what throttles the gas a quarter of a turn away.
fn pressure(observed: &OrderLines, predicted: &OrderLines) -> Result<(), String> {
    let [recorded, machine] = [observed, predicted].map(|lines| lines.amplitude[1]);
    let apart = (recorded / machine).arg();
    let is_opposite = (PI - apart.abs()).to_degrees() < PHASE;
    if !is_opposite || recorded.norm() < machine.norm() / FACTOR {
        return Ok(());
    }
    Err(format!(
        "its first order leads that of the machine by {:.0} deg: check that it is the pressure of this end of the cylinder \
         and not of the other one, and that the crank angle is 0 at top dead centre",
        apart.to_degrees()
    ))
}

/// Whether a line is this many times what the machine gives because its sensor passes no slow changes: a high pass of first order
/// passes cos φ of a line, which then leads by φ.
fn is_high_passed(ratio: Complex64) -> bool {
    let lead = ratio.arg();
    let passed = ratio.norm() / lead.cos();
    (0.0..FRAC_PI_2).contains(&lead) && (1.0 / FACTOR..=FACTOR).contains(&passed)
}

/// Whether a pressure has a zero to count from.
fn has_mean(lines: &OrderLines) -> bool {
    let [least, greatest] = extremes(lines);
    lines.amplitude[0].norm() > NO_MEAN * (greatest - least)
}

/// Least and greatest value of a synchronous mean, from its first orders.
fn extremes(lines: &OrderLines) -> [f64; 2] {
    let values = recorded(lines, 0.0, true).pressures.into_iter();
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    })
}

/// A synchronous mean over the revolution, from its first orders. The recorded angles are ahead of the crank by `offset`, rad.
fn recorded(lines: &OrderLines, offset: f64, forward: bool) -> Recorded {
    let grid = (0..POINTS).map(|i| TAU * i as f64 / POINTS as f64);
    let value = |angle: f64| {
        let terms = lines.amplitude.iter().take(POINTS / 4).enumerate();
        let value = terms.map(|(k, c)| {
            let (sin, cos) = (k as f64 * angle).sin_cos();
            c.re * cos - c.im * sin
        });
        value.sum::<f64>()
    };
    Recorded {
        angles: grid.clone().map(|angle| angle - offset).collect(),
        pressures: grid.map(value).collect(),
        forward,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sensor_may_pass_no_slow_changes() {
        let passed = |cutoff: f64| Complex64::new(1.0, 0.0) / Complex64::new(1.0, -cutoff);
        assert!([0.1, 1.4, 5.0].map(passed).into_iter().all(is_high_passed));
        // Another unit or stroke, another zero of the crank angle, and a low pass.
        let others = [
            Complex64::new(0.5, 0.0),
            Complex64::new(2.0, 0.1),
            Complex64::from_polar(1.0, 1.2),
            Complex64::from_polar(1.0, -1.0),
            passed(1.4).conj(),
        ];
        assert!(!others.into_iter().any(is_high_passed));
    }

    #[test]
    fn a_pressure_that_falls_where_the_machine_raises_it_is_of_the_other_end() {
        let of = |first: Complex64| OrderLines {
            amplitude: vec![3e5.into(), first],
            variance: vec![0.0; 2],
            revolutions: 30,
        };
        let machine = of(Complex64::from_polar(1e5, 0.4));
        let turned =
            |by: f64, times: f64| of(machine.amplitude[1] * Complex64::from_polar(times, by));
        assert!(pressure(&turned(1.0, 1.4), &machine).is_ok());
        assert!(pressure(&turned(3.0, 0.3), &machine).is_ok());
        let reason = pressure(&turned(-3.0, 0.9), &machine).unwrap_err();
        assert!(reason.contains("by -172 deg"), "{reason}");
    }

    #[test]
    fn a_pressure_has_a_mean_unless_its_sensor_passes_nothing_slow() {
        let of = |mean: f64| OrderLines {
            amplitude: vec![
                mean.into(),
                Complex64::new(-1e5, 2e4),
                Complex64::new(3e4, 0.0),
            ],
            variance: vec![0.0; 3],
            revolutions: 30,
        };
        // Absolute, gauge, with a drifted zero; and behind a capacitor, which leaves little more than noise of the mean.
        assert!([2e5, 1e5, -3e4].map(of).iter().all(has_mean));
        assert!(![0.0, 400.0, -400.0].map(of).iter().any(has_mean));
    }

    #[test]
    fn pairs_are_opposed_where_both_differ_clearly() {
        assert!(are_opposed([3.0, 3.9], [3.9, 3.0]));
        assert!(!are_opposed([3.0, 3.9], [3.0, 3.9]));
        // Losses of valves at another speed.
        assert!(!are_opposed([3.0, 3.2], [3.2, 3.0]));
        assert!(!are_opposed([3.0, 3.0], [3.9, 3.0]) && !are_opposed([-1.0, 3.0], [3.0, 1.0]));
    }
}
