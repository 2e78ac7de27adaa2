//! What a calibration makes of its input: what is fitted, the zero of the crank angle, swapped runs.

use super::example_run::*;
use ::calibrate::Task;
use std::f64::consts::TAU;
use std::fs;

/// The names of what a task fits.
fn fitted(task: &Task) -> Vec<&str> {
    let parameters = task.problem.parameters.iter();
    parameters.map(|p| p.path.as_str()).collect()
}

#[test]
fn joints_of_which_no_run_speaks_are_those_of_the_machine() {
    let columns = plain();
    let mute = yaml(&columns).replace(
        "  joints:\n    big_end:\n      clearance_m: 0.0001\n    small_end:\n      clearance_m: 0.0001\n",
        "",
    );
    assert!(!mute.contains("joints:"));
    let folder = write(&mute, &csv(&columns));
    let machine = example().join("../../machines/single-stage.yaml");
    let machine = fs::read_to_string(machine).unwrap().replace(
        "clearance: ideal                # paper",
        "clearance: 0.1 mm               # paper",
    );
    fs::write(folder.path().join("machine.yaml"), machine).unwrap();
    let task = task_of(folder.path(), "bundle: bundle\nmachine: machine.yaml\n");
    let contact = |joint: &str| {
        [
            "contact.stiffness",
            "contact.damping",
            "friction.coefficient",
        ]
        .map(|key| format!("joints.{joint}.{key}"))
    };
    let mut expected = [contact("big_end"), contact("small_end")].concat();
    expected.push("crank_angle_offset".into());
    assert_eq!(fitted(&task), expected);
}

#[test]
fn the_zero_of_the_crank_angle_is_fitted_whatever_is_asked_for() {
    let folder = written(&plain());
    let asked = "bundle: bundle\nparameters: [rod.mass]\n";
    assert_eq!(
        fitted(&task_of(folder.path(), asked)),
        ["rod.mass", "crank_angle_offset"]
    );
    let named =
        "bundle: bundle\nparameters: {crank_angle_offset: {bounds: [-1 deg, 1 deg]}, rod.mass: }\n";
    let task = task_of(folder.path(), named);
    assert_eq!(fitted(&task), ["crank_angle_offset", "rod.mass"]);
}

#[test]
fn a_keyphasor_anywhere_on_the_shaft_is_found() {
    for degrees in [30.0_f64, 170.0, -100.0] {
        let offset = degrees.to_radians();
        let mut columns = plain();
        for angle in &mut columns[1].2 {
            *angle = (*angle + offset).rem_euclid(TAU);
        }
        let task = task_of(written(&columns).path(), "bundle: bundle\n");
        let start = task.settings.start.as_ref().unwrap();
        let last = task.problem.parameters.last().unwrap();
        let found = last.value(*start.last().unwrap());
        println!("{degrees} deg: found {:.3} deg", found.to_degrees());
        assert!((found - offset).abs() < 0.01, "{degrees}: {found}");
        assert!(last.bounds[0] < offset && offset < last.bounds[1]);
    }
    // Near top dead centre everything is as it was.
    assert!(
        task_of(written(&plain()).path(), "bundle: bundle\n")
            .settings
            .start
            .is_none()
    );
}

/// The columns of these names alone, with the pulses of a tacho at a crank angle, rad, in place of the crank angle.
fn pulsed(names: [&str; 2], at: f64) -> Vec<Column> {
    let mut columns = plain();
    let angle = columns[1].2.clone();
    columns.retain(|column| names.contains(&column.0));
    // An edge of 2° is as steep as the samples resolve.
    let edge = |a: f64| {
        let since = (a - at + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
        (since / 2.0_f64.to_radians() + 0.5).clamp(0.0, 1.0)
            * f64::from(u8::from(since < 0.3))
            * 5.0
    };
    let pulses = angle.iter().map(|a| edge(*a)).collect();
    columns.push((
        "trigger",
        "{name: keyphasor, column: trigger, unit: V}",
        pulses,
    ));
    columns
}

#[test]
fn a_pulse_anywhere_is_found_by_pressure_or_acceleration_alone() {
    for name in ["cylinder_pressure_pa", "crosshead_acceleration_m_s2"] {
        for degrees in [137.0_f64, -90.0] {
            let at = degrees.to_radians();
            // A tacho of unknown place.
            let task = task_of(
                written(&pulsed(["t_s", name], at)).path(),
                "bundle: bundle\n",
            );
            let (run, found) = task.pulse_angles().next().unwrap();
            let apart = (found - at + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
            println!(
                "{name}, pulse at {degrees} deg: {:.2} deg",
                found.to_degrees()
            );
            assert!(apart.abs() < 0.02 && run == "run03", "{degrees}: {found}");
            // An encoder whose zero is there.
            let mut columns = plain();
            for angle in &mut columns[1].2 {
                *angle = (*angle + at).rem_euclid(TAU);
            }
            columns.retain(|column| ["t_s", "crank_angle_rad", name].contains(&column.0));
            let task = task_of(written(&columns).path(), "bundle: bundle\n");
            let start = task.settings.start.as_ref().unwrap();
            let last = task.problem.parameters.last().unwrap();
            let found = last.value(*start.last().unwrap());
            println!(
                "{name}, zero at {degrees} deg: {:.2} deg",
                found.to_degrees()
            );
            assert!((found - at).abs() < 0.02, "{degrees}: {found}");
        }
    }
}

#[test]
fn a_pulse_whose_place_the_recordings_do_not_show_is_refused() {
    // Twice a revolution the same: half a turn changes nothing.
    let mut columns = pulsed(["t_s", "crosshead_acceleration_m_s2"], 0.5);
    let [_, angle, ..] = recorded();
    for (x, angle) in columns[1].2.iter_mut().zip(&angle) {
        *x = 40.0 * (2.0 * angle).cos() + 1e-2 * (1e3 * angle).sin();
    }
    let folder = written(&columns);
    let (status, message) = calibrate(folder.path(), &["bundle", "--out", "out"]);
    assert_eq!(status, 2, "{message}");
    assert!(
        message.contains("do not show where the crank stands") && message.contains("run03"),
        "{message}"
    );
    // With its place told the recordings are held against the machine.
    let told = yaml(&columns).replace("unit: V}", "unit: V, crank_angle_rad: 0.5}");
    let folder = write(&told, &csv(&columns));
    let (status, message) = calibrate(folder.path(), &["bundle", "--out", "out"]);
    assert!(status == 2 && message.contains("first order"), "{message}");
}

#[test]
fn runs_whose_loads_are_swapped_are_told() {
    let columns = plain();
    let first = yaml(&columns);
    let (machine, run) = first.split_once("runs:\n").unwrap();
    let other = run.replace("run03", "run06").replace("393000", "300000");
    let bundle = |runs: String| {
        let folder = write(&format!("{machine}runs:\n{runs}"), &csv(&columns));
        let other = csv(&self::columns(recorded_in("run06")));
        fs::write(folder.path().join("bundle/run06.csv"), other).unwrap();
        folder
    };
    let folder = bundle(format!("{run}{other}"));
    assert_eq!(task_of(folder.path(), "bundle: bundle\n").runs.len(), 2);
    let [run, other] = [
        run.replace("393000", "300000"),
        other.replace("300000", "393000"),
    ];
    let folder = bundle(format!("{run}{other}"));
    let (status, message) = calibrate(folder.path(), &["bundle", "--out", "out"]);
    assert_eq!(status, 2, "{message}");
    assert!(
        message.contains("are the two recordings or their loads swapped?"),
        "{message}"
    );
    assert!(
        message.contains("run run06") && message.contains("run03"),
        "{message}"
    );
}
