//! What a calibration found, in words.

use super::{Correction, Diagram, Estimate, Gas, Known, Relations, Results, Tried};
use crate::shut_valve::sentences;
use std::fmt;

/// A line for each parameter, run and sensor, and what the model does not explain.
impl fmt::Display for Results {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if !self.complete {
            writeln!(f, "stopped; the best so far:")?;
        }
        for (path, estimate) in self.parameters.iter() {
            writeln!(f, "{path}: {}", estimate_text(estimate))?;
        }
        for (id, run) in self.runs.iter() {
            let kind = match run.held_out {
                true => "predicted",
                false => "fitted",
            };
            writeln!(
                f,
                "{id} {kind}: {:.2} times its noise, {:.2} before",
                run.calibrated, run.nominal
            )?;
        }
        if let Some(tried) = &self.corrections_tried {
            corrections(f, &self.corrections, tried)?;
        }
        if !self.model_is_adequate && self.complete {
            writeln!(
                f,
                "the model is wrong: it leaves {:.2} times the noise{}; above 1.5 no interval is known, and no value \
             is to be relied on",
                self.fit.calibrated.unwrap_or(f64::NAN),
                predicted(self.fit.heldout_calibrated)
            )?;
        }
        for shut in sentences(&self.shut_valves) {
            writeln!(f, "{shut}")?;
        }
        for (run, channels) in self.gas.iter().flat_map(|runs| runs.iter()) {
            for (column, found) in channels.iter() {
                gas(f, run, column, found)?;
            }
        }
        for (column, sensor) in &self.noise {
            writeln!(f, "sensor {column}: {sensor}")?;
        }
        match &self.relations {
            Some(compared) => relations(f, compared),
            None => Ok(()),
        }
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

/// Which values of the data sheet were looked at because the model was wrong, and what came of it.
fn corrections(f: &mut fmt::Formatter, corrections: &[Correction], tried: &[Tried]) -> fmt::Result {
    for correction in corrections {
        let stated = match correction.nominal {
            Some(nominal) => format!("in place of the stated {nominal:.5e}"),
            None => "without a stated value".to_owned(),
        };
        let end = match correction.applied {
            true => "; machine.yaml has it",
            false => "",
        };
        writeln!(
            f,
            "data sheet: {} = {:.5e} ({:.5e} to {:.5e}), {stated}, explains the recordings ({:.2} times the noise, \
             probability {:.2}){end}",
            correction.path,
            correction.value,
            correction.low.unwrap_or(f64::NAN),
            correction.high.unwrap_or(f64::NAN),
            correction.misfit,
            correction.probability,
        )?;
    }
    if corrections.len() > 1 && corrections.iter().all(|c| !c.applied) {
        writeln!(
            f,
            "data sheet: the recordings do not distinguish these values, so none is corrected: measure them"
        )?;
    }
    if let (true, Some(nearest)) = (corrections.is_empty(), tried.first()) {
        writeln!(
            f,
            "data sheet: no single value explains the recordings; {} reduces the misfit most, to {:.2} times the noise",
            nearest.path, nearest.misfit
        )?;
    }
    Ok(())
}

fn gas(f: &mut fmt::Formatter, run: &str, column: &str, found: &Gas) -> fmt::Result {
    writeln!(
        f,
        "{run} {column}: {:.1} kPa RMS from the recording, {:.1} kPa before",
        found.rms_pa.calibrated / 1e3,
        found.rms_pa.nominal / 1e3
    )?;
    let (Some(measured), Some(calibrated)) = (&found.measured, &found.calibrated) else {
        return Ok(());
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
    writeln!(f, "  {}", events.collect::<Vec<_>>().join("; "))
}

/// How the relations between clearances compare, if the recordings distinguish them.
fn relations(f: &mut fmt::Formatter, found: &Relations) -> fmt::Result {
    let decided = &found.decision.relations;
    if decided.is_empty() {
        return Ok(());
    }
    for compared in &found.compared {
        writeln!(
            f,
            "relation {}: {:.2} times the noise fitted{}",
            compared.relation.name(),
            compared.fitted,
            predicted(compared.held_out)
        )?;
    }
    let decided: Vec<&str> = decided.iter().map(|relation| relation.name()).collect();
    writeln!(f, "relation that the data favour: {}", decided.join(" or "))
}
