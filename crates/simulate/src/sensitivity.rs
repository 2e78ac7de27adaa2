//! How a record changes with the machine's parameters: exact derivatives by dual numbers.
//!
//! The motion is integrated once more over dual numbers, whose tangents carry the derivative of every
//! coordinate with respect to every parameter. Switches count, because the integrator carries the
//! derivative of their times. With a transient of a given number of revolutions, the derivatives are
//! those of the motion from its start. For a motion that has settled they are those of the periodic
//! `orbit`. On a chaotic one they grow without bound: compare statistics by differences.

pub use crate::moved::Moved;
pub use crate::recorder::Sensitivities;

use crate::asked::Asked;
use crate::error::Error;
use crate::orbit::Orbit;
use crate::recorder::{Recorder, apart};
use crate::run::Run;
use crate::sensor::Sensor;
use crate::settings::{Settings, Transient};
use crate::span::Span;
use integrate::Real;
use mechanism::{Machine, lift};
use scalar::Dual;

/// Runs a machine and records its sensors with the derivatives toward each of `moved`. Of a motion that
/// settles no more is recorded than its period, and a revolution beyond where the crank is free and
/// does not keep to its reference speed. Of one that was to settle and does not there are no
/// derivatives. A motion that takes some 50 times as many steps as a usual one is given up.
///
/// # Errors
/// As [`simulate`](crate::simulate()).
pub fn sensitivities(asked: &Asked, moved: &[Moved]) -> Result<Sensitivities, Error> {
    let Asked {
        machine,
        sensors,
        settings,
        ..
    } = *asked;
    if matches!(settings.transient, Transient::Revolutions(_)) {
        return from_start(asked, moved);
    }
    let mut run = Run::begin(asked, machine.clone(), false);
    run.hurry();
    let (transient, period) = run.leave_transient(settings.transient)?;
    let Some(period) = period else {
        let (recorder, inner) = recorded(&mut run, transient, sensors, settings)?;
        let unsettled = recorder.sensitivities(machine, sensors, &[], &inner, &[])?;
        return Ok(Sensitivities {
            steps: run.steps(),
            ..unsettled
        });
    };
    let orbit = Orbit {
        machine,
        sensors,
        moved,
        settings,
        period,
    };
    let carried = orbit.carried(run)?;
    let (inner, tangents) = (&carried.values, &carried.tangents);
    let recorder = &carried.recorder;
    Ok(Sensitivities {
        settled: true,
        steps: carried.steps,
        ..recorder.sensitivities(machine, sensors, moved, inner, tangents)?
    })
}

/// The derivatives of the motion from its start, eight of them at a time; the last tangents of an
/// incomplete chunk are 0.
fn from_start(asked: &Asked, moved: &[Moved]) -> Result<Sensitivities, Error> {
    let part = |chunk: &[Moved]| match chunk.len() {
        0 => values(asked),
        1 => tangents::<1>(asked, chunk),
        _ => tangents::<8>(asked, chunk),
    };
    let mut chunks = moved.chunks(8);
    let mut all = part(chunks.next().unwrap_or_default())?;
    for chunk in chunks {
        let part = part(chunk)?;
        all.derivatives.extend(part.derivatives);
        all.steps += part.steps;
    }
    Ok(all)
}

fn values(asked: &Asked) -> Result<Sensitivities, Error> {
    let Asked {
        machine,
        sensors,
        settings,
        ..
    } = *asked;
    let mut run = Run::begin(asked, machine.clone(), false);
    run.hurry();
    let (transient, period) = run.leave_transient(settings.transient)?;
    let (recorder, inner) = recorded(&mut run, transient, sensors, settings)?;
    Ok(Sensitivities {
        settled: period.is_some(),
        steps: run.steps(),
        ..recorder.sensitivities(machine, sensors, &[], &inner, &[])?
    })
}

fn tangents<const N: usize>(asked: &Asked, moved: &[Moved]) -> Result<Sensitivities, Error> {
    let Asked {
        machine,
        sensors,
        settings,
        ..
    } = *asked;
    let towards = std::array::from_fn(|i| moved.get(i).map_or(machine, |moved| &moved.machine));
    let lifted = lift::gradient::<N, Machine>(machine, towards);
    let mut run = Run::<Dual<f64, N>>::begin(asked, lifted, false);
    run.hurry();
    let (transient, period) = run.leave_transient(settings.transient)?;
    let (recorder, inner) = recorded(&mut run, transient, sensors, settings)?;
    let (values, tangents) = apart(&inner);
    Ok(Sensitivities {
        settled: period.is_some(),
        steps: run.steps(),
        ..recorder.sensitivities(machine, sensors, moved, &values, &tangents)?
    })
}

/// What the sensors measure in the revolutions after a transient.
fn recorded<S: Real>(
    run: &mut Run<S>,
    transient: u32,
    sensors: &[Sensor],
    settings: &Settings,
) -> Result<(Recorder, Vec<Vec<S>>), Error> {
    let Span {
        sampling,
        start,
        instants,
        ..
    } = Span::after(run, transient, sensors, settings)?;
    let mut inner = vec![Vec::new(); sensors.len()];
    run.show(instants, |at| {
        for (sensor, inner) in sensors.iter().zip(&mut inner) {
            inner.push(sensor.measured.value(at));
        }
    })?;
    Ok((Recorder { sampling, start }, inner))
}
