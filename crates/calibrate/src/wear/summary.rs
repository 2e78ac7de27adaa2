//! What an estimation of wear found, in words.

use super::{Contact, Interval, JointWear, Results};
use std::fmt;

/// A line for each joint, and how far the model explains the recordings.
impl fmt::Display for Results {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if !self.complete {
            writeln!(f, "stopped; the best so far:")?;
        }
        for (path, joint) in self.joints.iter() {
            writeln!(
                f,
                "{path}: {}{}; {}",
                joint.verdict.name(),
                clearance(joint),
                joint.reason
            )?;
        }
        for pair in &self.together {
            let [a, b] = &pair.joints;
            writeln!(
                f,
                "{a} and {b}: their clearances are strongly correlated ({:.2})",
                pair.correlation
            )?;
        }
        for run in &self.scattering_runs {
            writeln!(
                f,
                "{run}: its motion does not repeat itself, and it was not compared"
            )?;
        }
        for (run, angle) in self.pulse_angles_rad.iter() {
            writeln!(
                f,
                "{run}: the pulse of the tacho comes at a crank angle of {:.2}°",
                angle.to_degrees()
            )?;
        }
        let contact = match self.contact {
            Contact::MachineFile => "contact parameters of the machine file",
            Contact::Fitted => "contact parameters fitted",
        };
        writeln!(
            f,
            "misfit {:.2} times the noise, {:.2} with the healthy machine; {contact}",
            self.fit.estimated, self.fit.healthy
        )?;
        match (self.interval, self.timing_rad) {
            (Interval::Discrepancy, Some(timing)) => writeln!(
                f,
                "more than noise is left: the intervals include the model's discrepancy, {:.1} mrad of timing",
                1e3 * timing
            ),
            (Interval::Scatter, _) => writeln!(
                f,
                "the motion does not repeat itself: the intervals include its scatter"
            ),
            (Interval::None, _) if !self.complete => {
                writeln!(f, "no interval: the search was stopped before its end")
            }
            (Interval::None, _) => {
                writeln!(f, "no interval: the model does not explain the recordings")
            }
            _ => Ok(()),
        }
    }
}

fn clearance(joint: &JointWear) -> String {
    let Some(clearance) = joint.clearance_m else {
        return String::new();
    };
    let decimals = joint.decimals_mm();
    let interval = match joint.low_m.zip(joint.high_m) {
        Some((low, high)) => format!(
            " ({:.decimals$} to {:.decimals$} mm)",
            1e3 * low,
            1e3 * high
        ),
        None => String::new(),
    };
    format!(
        ", radial clearance {:.decimals$} mm{interval}, diametral {:.decimals$} mm",
        1e3 * clearance,
        2e3 * clearance
    )
}
