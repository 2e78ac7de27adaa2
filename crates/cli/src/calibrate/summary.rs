//! What a calibration found, as it is printed.

use ::calibrate::converter::Converter;
use ::calibrate::recorded_sensor::{RecordedNoise, RecordedSensor};
use ::calibrate::results::{Correction, Diagram, Estimate, Gas, Known, Relations, Results, Tried};
use ::calibrate::shut_valve::sentences;
use std::collections::BTreeMap;

/// Prints the results of a calibration.
pub(crate) fn print(results: &Results) {
    if !results.complete {
        println!("stopped; the best so far:");
    }
    for (path, estimate) in results.parameters.iter() {
        println!("{path}: {}", estimate_text(estimate));
    }
    for (id, run) in results.runs.iter() {
        let kind = match run.held_out {
            true => "predicted",
            false => "fitted",
        };
        println!(
            "{id} {kind}: {:.2} times its noise, {:.2} before",
            run.calibrated, run.nominal
        );
    }
    if let Some(tried) = &results.corrections_tried {
        corrections(&results.corrections, tried);
    }
    if !results.model_is_adequate {
        println!(
            "the model is wrong: it leaves {:.2} times the noise{}; above 1.5 no interval is known, and no value \
             is to be relied on",
            results.fit.calibrated.unwrap_or(f64::NAN),
            predicted(results.fit.heldout_calibrated)
        );
    }
    for shut in sentences(&results.shut_valves) {
        println!("{shut}");
    }
    for (run, channels) in results.gas.iter().flat_map(|runs| runs.iter()) {
        for (column, found) in channels.iter() {
            gas(run, column, found);
        }
    }
    sensors(&results.noise);
    if let Some(compared) = &results.relations {
        relations(compared);
    }
}

fn estimate_text(estimate: &Estimate) -> String {
    let value = estimate.value;
    match estimate.known() {
        Known::Within([low, high]) => {
            let stuck = match estimate.at_bound {
                true => ": at its bound, and the recordings ask for more",
                false => "",
            };
            format!("{value:.4e} ({low:.4e} to {high:.4e}){stuck}")
        }
        Known::Fitted => {
            format!("{value:.4e} (no interval: the model is wrong)")
        }
        Known::Nothing => format!("not identifiable from the recordings; it stays {value:.4e}"),
    }
}

fn predicted(misfit: Option<f64>) -> String {
    misfit.map_or(String::new(), |misfit| format!(", {misfit:.2} predicted"))
}

/// Prints which values of the data sheet were looked at because the model was wrong, and what came of it.
fn corrections(corrections: &[Correction], tried: &[Tried]) {
    for correction in corrections {
        let stated = match correction.nominal {
            Some(nominal) => format!("in place of the stated {nominal:.5e}"),
            None => "without a stated value".to_owned(),
        };
        let end = match correction.applied {
            true => "; machine.yaml has it",
            false => "",
        };
        println!(
            "data sheet: {} = {:.5e} ({:.5e} to {:.5e}), {stated}, explains the recordings ({:.2} times the noise, \
             probability {:.2}){end}",
            correction.path,
            correction.value,
            correction.low.unwrap_or(f64::NAN),
            correction.high.unwrap_or(f64::NAN),
            correction.misfit,
            correction.probability,
        );
    }
    if corrections.len() > 1 && corrections.iter().all(|c| !c.applied) {
        println!(
            "data sheet: the recordings do not distinguish these values, so none is corrected: measure them"
        );
    }
    if let (true, Some(nearest)) = (corrections.is_empty(), tried.first()) {
        println!(
            "data sheet: no single value explains the recordings; {} reduces the misfit most, to {:.2} times the noise",
            nearest.path, nearest.misfit
        );
    }
}

fn gas(run: &str, column: &str, found: &Gas) {
    println!(
        "{run} {column}: {:.1} kPa RMS from the recording, {:.1} kPa before",
        found.rms_pa.calibrated / 1e3,
        found.rms_pa.nominal / 1e3
    );
    let (Some(measured), Some(calibrated)) = (&found.measured, &found.calibrated) else {
        return;
    };
    let events = |diagram: &Diagram| {
        let events = &diagram.valve_events;
        [
            events.suction_closes,
            events.discharge_opens,
            events.suction_opens,
        ]
        .map(|event| event.crank_angle_deg)
    };
    let both = events(measured).into_iter().zip(events(calibrated));
    let names = ["suction closes", "discharge opens", "suction opens"];
    let events = names.iter().zip(both).map(|(name, (measured, fitted))| {
        format!("{name} at {measured:.0} deg, in the fit at {fitted:.0}")
    });
    println!("  {}", events.collect::<Vec<_>>().join("; "));
}

/// Prints how the relations between clearances compare, if the recordings distinguish them.
fn relations(found: &Relations) {
    let decided = &found.decision.relations;
    if decided.is_empty() {
        return;
    }
    for compared in &found.compared {
        println!(
            "relation {}: {:.2} times the noise fitted{}",
            compared.relation.name(),
            compared.fitted,
            predicted(compared.held_out)
        );
    }
    let decided: Vec<&str> = decided.iter().map(|relation| relation.name()).collect();
    println!("relation that the data favour: {}", decided.join(" or "));
}

/// Prints the sensors.
pub(crate) fn sensors(sensors: &BTreeMap<String, RecordedSensor>) {
    for (column, sensor) in sensors {
        println!(
            "sensor {column}: {}; {}",
            noise(&sensor.noise),
            converter(&sensor.converter)
        );
    }
}

fn noise(found: &RecordedNoise) -> String {
    let reason = found.noise_reason.as_deref().unwrap_or_default();
    match (found.rms, found.at_most) {
        (Some(rms), _) => {
            let share = found.of_signal.map_or(String::new(), |share| {
                format!(", {:.2} % of its signal", 100.0 * share)
            });
            let pink = 100.0 * found.pink_share.unwrap_or(0.0);
            format!("noise {rms:.3e} rms{share}, {pink:.0} % of it 1/f")
        }
        (None, Some(most)) => format!("noise unknown, at most {most:.3e} rms: {reason}"),
        (None, None) => format!("noise unknown: {reason}"),
    }
}

fn converter(found: &Converter) -> String {
    match found {
        Converter::RangeAssumed {
            resolution,
            bits_needed,
            bits,
            range,
        } => format!(
            "steps of {resolution:.3e}, {bits_needed} bits or more; its range is not identifiable, \
             {bits} bits are assumed, or {range:.3e}"
        ),
        Converter::RangePerRun {
            resolution,
            finest,
            bits,
        } => format!(
            "steps of {finest:.3e} to {resolution:.3e}, {bits} bits over a range set to each run"
        ),
        Converter::Encoder { bits, .. } => format!("{bits} bits to the turn"),
        Converter::Unknown { converter_reason } => format!("no bits: {converter_reason}"),
    }
}
