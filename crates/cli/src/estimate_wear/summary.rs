//! What `crosshead estimate-wear` prints.

use ::calibrate::wear::{Contact, Interval, JointWear, Results};

/// Prints a line per joint, and how far the model explains the recordings.
pub(super) fn print(results: &Results) {
    for (path, joint) in results.joints.iter() {
        println!(
            "{path}: {}{}; {}",
            joint.verdict.name(),
            clearance(joint),
            joint.reason
        );
    }
    for pair in &results.together {
        let [a, b] = &pair.joints;
        println!(
            "{a} and {b}: their clearances are strongly correlated ({:.2})",
            pair.correlation
        );
    }
    for (run, angle) in results.pulse_angles_rad.iter() {
        println!(
            "{run}: the pulse of the tacho comes at a crank angle of {:.2}°",
            angle.to_degrees()
        );
    }
    let contact = match results.contact {
        Contact::MachineFile => "contact parameters of the machine file",
        Contact::Fitted => "contact parameters fitted",
    };
    println!(
        "misfit {:.2} times the noise, {:.2} with the healthy machine; {contact}",
        results.fit.estimated, results.fit.healthy
    );
    match (results.interval, results.timing_rad) {
        (Interval::Discrepancy, Some(timing)) => println!(
            "the model does not explain the recordings: the intervals include its discrepancy, {:.1} mrad of timing",
            1e3 * timing
        ),
        (Interval::None, _) => println!("no interval: the model does not explain the recordings"),
        _ => {}
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
