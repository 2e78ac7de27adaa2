//! The measuring chain that recordings show, against what it was: recordings of another program with
//! their truth, and recordings made here.

use calibrate::converter::{ASSUMED_BITS, Converter};
use calibrate::problem::columns;
use calibrate::recorded_sensor::{Look, RecordedSensor, recorded_sensors, sample_rate};
use calibrate::{Channel, Observation, Run, bundle, sensor_section};
use input::bundle::Bundle;
use input::{MachineFile, machine_file, paths};
use scalar::random::{Purpose, stream};
use serde_json::{Value, json};
use simulate::{Settings, Transient};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const ACCELERATION: &str = "crosshead_acceleration_m_s2";
const PRESSURE: &str = "cylinder_pressure_pa";

fn data(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../data")
        .join(path)
}

fn sensors(runs: &[Run], columns: &[String]) -> (BTreeMap<String, RecordedSensor>, Option<f64>) {
    let observed: Vec<Observation> = runs
        .iter()
        .map(|run| Observation::from_run(run, columns).unwrap())
        .collect();
    let looks: Vec<Look> = runs
        .iter()
        .zip(&observed)
        .map(|(run, observation)| Look {
            run,
            observation,
            prediction: None,
            has_encoder: true,
        })
        .collect();
    (recorded_sensors(&looks), sample_rate(&looks))
}

fn of_bundle(name: &str) -> (BTreeMap<String, RecordedSensor>, Option<f64>, Value) {
    let bundle = Bundle::read(&data("recordings").join(name)).unwrap();
    let mut tree = input::from_bundle(&bundle.machine).unwrap();
    let runs = bundle::runs(&bundle, &tree, &[]).unwrap();
    for (path, value) in &runs[0].settings {
        paths::set(&mut tree, path, value.clone()).unwrap();
    }
    let machine = MachineFile::from_tree(&tree).unwrap().resolve().unwrap();
    let (found, rate) = sensors(&runs, &columns(&machine));
    (found, rate, tree)
}

fn near(found: Option<f64>, expected: f64, tolerance: f64) {
    let found = found.expect("a value");
    assert!(
        (found / expected - 1.0).abs() < tolerance,
        "{found} for {expected}"
    );
}

#[test]
fn noise_of_another_programs_recordings_is_their_truth() {
    let (found, rate, mut tree) = of_bundle("example-single-stage");
    let acceleration = &found[ACCELERATION];
    // truth.yaml: acceleration_rel_rms, 30 % of the power 1/f, 16 bits.
    near(acceleration.noise.of_signal, 0.029_463_5, 0.03);
    near(acceleration.noise.pink_share, 0.3, 0.1);
    // The recorder set its range to each run: 512, 1024 and 2048 m/s².
    let Converter::RangePerRun {
        resolution,
        finest,
        bits,
    } = acceleration.converter
    else {
        panic!("{acceleration:?}");
    };
    assert_eq!(bits, 16);
    near(Some(resolution), 2048.0 / 32768.0, 1e-3);
    near(Some(finest), 512.0 / 32768.0, 1e-3);
    // pressure_rel_range 0.004572, of 0.105 to 0.393 and to 0.3 MPa: by run 1317 or 891 Pa.
    let pressure = &found[PRESSURE];
    near(pressure.noise.pink_share, 0.3, 0.1);
    // 16 bits over ±1 MPa, of which 15 are used.
    step_is(&pressure.converter, 1e6 / 32768.0);
    let encoder = &found["crank_angle_rad"].converter;
    assert!(matches!(encoder, Converter::Encoder { bits: 16, .. }));
    assert_eq!(rate, Some(20_000.0));

    sensor_section::write(&mut tree, &found, rate).unwrap();
    let machine = MachineFile::from_tree(&tree).unwrap().resolve().unwrap();
    assert_eq!(machine.sample_rate, Some(20_000.0));
    let chain = &machine.sensors[0].chain;
    assert_eq!(chain.range, Some(simulate::Range::Auto));
    let noise = chain.noise.unwrap();
    let simulate::NoiseLevel::OfSignal(level) = noise.level else {
        panic!("{noise:?}");
    };
    near(Some(level), 0.029_463_5, 0.03);
}

/// Run 4 of the second throw scatters from revolution to revolution by 5 % of its RMS (truth.yaml),
/// its sensor by 2.2 %.
#[test]
fn a_run_whose_motion_scatters_is_left_out() {
    let (found, ..) = of_bundle("example-two-stage");
    for throw in ["throw1", "throw2"] {
        let sensor = &found[&format!("{throw}.{ACCELERATION}")];
        near(sensor.noise.of_signal, 0.022_248_5, 0.03);
        near(sensor.noise.pink_share, 0.3, 0.15);
    }
    let throw2 = &found[&format!("throw2.{ACCELERATION}")];
    assert_eq!(throw2.noise.runs, ["run01", "run02", "run03"]);
}

/// A machine of `data/machines` with the sensors of `chain`, recorded at each speed.
fn recorded(changes: &[(&str, &str)], speeds: &[&str], chain: Value) -> Vec<Run> {
    let file = machine_file::read(&data("machines/single-stage.yaml")).unwrap();
    let of_speed = |(i, speed): (usize, &&str)| {
        let mut tree = file.to_tree().clone();
        tree["sensors"] = json!([chain, {"measure": "crank_angle", "bits": 16}]);
        for (path, value) in changes.iter().chain([&("speed", *speed)]) {
            paths::set(&mut tree, path, Value::from(*value)).unwrap();
        }
        let machine = MachineFile::from_tree(&tree).unwrap().resolve().unwrap();
        let settings = Settings {
            transient: Transient::Revolutions(20),
            revolutions: 20,
            sample_rate: 10_000.0,
            tolerance: 1e-8,
            ..Settings::default()
        };
        let record =
            simulate::simulate(&machine.machine, &machine.sensors, &settings, false).unwrap();
        let mut random = stream(i as u64, 0, Purpose::Noise);
        let channels = simulate::measure(&record, &machine.sensors, &[""], &mut random);
        let samples = |i: usize| channels[i].samples.iter().map(|x| f64::from(*x)).collect();
        Run {
            id: format!("run{i}"),
            settings: Vec::new(),
            speed_rpm: speed.trim_end_matches(" rpm").parse().unwrap(),
            sample_rate: 10_000.0,
            is_timed: true,
            crank_angle: Some(samples(1)),
            channels: vec![Channel {
                column: channels[0].name.clone(),
                samples: samples(0),
            }],
        }
    };
    speeds.iter().enumerate().map(of_speed).collect()
}

#[test]
fn noise_of_a_sensor_that_does_not_follow_its_signal_comes_back() {
    let chain = json!({
        "measure": "crosshead_acceleration",
        "noise": {"rms": "5 m/s^2", "pink_share": "40 %"},
        "range": "1500 m/s^2", "bits": 12,
    });
    let worn = [("joints.big_end.clearance", "0.1 mm")];
    let runs = recorded(&worn, &["350 rpm", "500 rpm", "650 rpm"], chain);
    let (found, rate) = sensors(&runs, &[ACCELERATION.to_owned()]);
    let sensor = &found[ACCELERATION];
    near(sensor.noise.rms, 5.0, 0.05);
    near(sensor.noise.pink_share, 0.4, 0.15);
    assert_eq!(sensor.noise.of_signal, None);
    step_is(&sensor.converter, 3000.0 / 4096.0);
    assert_eq!(rate, Some(10_000.0));
}

/// With a tenth of the damping wide clearances rattle chaotically (README): what scatters is then no
/// noise.
#[test]
fn scatter_of_a_chaotic_motion_is_no_noise() {
    let chain = json!({"measure": "crosshead_acceleration", "noise": {"rms": "2 %"}});
    let chaotic = [
        ("joints.big_end.clearance", "0.3 mm"),
        ("joints.small_end.clearance", "0.3 mm"),
        ("joints.big_end.contact.damping", "2e3 N s/m"),
        ("joints.small_end.contact.damping", "2e3 N s/m"),
    ];
    let runs = recorded(&chaotic, &["500 rpm"], chain);
    let (found, _) = sensors(&runs, &[ACCELERATION.to_owned()]);
    let sensor = &found[ACCELERATION];
    assert_eq!(sensor.noise.rms, None);
    let reason = sensor.noise.noise_reason.as_deref().unwrap();
    assert!(reason.contains("the motion itself differs"), "{reason}");
    assert!(sensor.noise.at_most.is_some_and(|most| most > 0.0));
    let Converter::Unknown { converter_reason } = &sensor.converter else {
        panic!("{sensor:?}");
    };
    assert!(
        converter_reason.contains("no lattice"),
        "{converter_reason}"
    );
}

/// A converter of 18 bits over ±1600 m/s² records a machine in good order, which uses a quarter of that.
fn in_good_order() -> (BTreeMap<String, RecordedSensor>, Option<f64>) {
    let chain = json!({
        "measure": "crosshead_acceleration", "noise": {"rms": "2 m/s^2"},
        "range": "1600 m/s^2", "bits": 18,
    });
    let runs = recorded(
        &[("joints.big_end.clearance", "0.1 mm")],
        &["350 rpm"],
        chain,
    );
    sensors(&runs, &[ACCELERATION.to_owned()])
}

#[test]
fn a_worn_machine_is_recorded_in_the_same_steps_and_not_clipped() {
    let (found, rate) = in_good_order();
    let step = 3200.0 / 262_144.0;
    step_is(&found[ACCELERATION].converter, step);
    let file = machine_file::read(&data("machines/single-stage.yaml")).unwrap();
    let mut tree = file.to_tree().clone();
    tree["sensors"] = json!([]);
    sensor_section::write(&mut tree, &found, rate).unwrap();
    let worn = [
        ("joints.big_end.clearance", "0.4 mm"),
        ("joints.small_end.clearance", "0.4 mm"),
    ];
    let mut sections = tree["sensors"].as_array().unwrap().iter();
    let chain = sections.find(|s| s["measure"] == "crosshead_acceleration");
    let runs = recorded(&worn, &["650 rpm"], chain.unwrap().clone());
    let samples = &runs[0].channels[0].samples;
    let found = signal::quantisation::quantisation_step(samples);
    near(found, step, 1e-3);
    let largest = samples.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // Four times what a machine in good order shows, and no two samples at a limit.
    assert!(largest > 800.0, "{largest}");
    let at_largest = samples.iter().filter(|x| x.abs() == largest).count();
    assert_eq!(at_largest, 1);
}

/// What is not identifiable from the recordings keeps the value of the machine file.
#[test]
fn a_stated_range_stays_where_its_bits_are_whole() {
    let (found, rate) = in_good_order();
    for (range, expected) in [
        ("1600 m/s^2", (1600.0, 18)),
        ("3200 m/s^2", (3200.0, 19)),
        // Not with this step, and less than what was recorded.
        ("1500 m/s^2", (f64::NAN, ASSUMED_BITS)),
        ("100 m/s^2", (f64::NAN, ASSUMED_BITS)),
    ] {
        let file = machine_file::read(&data("machines/single-stage.yaml")).unwrap();
        let mut tree = file.to_tree().clone();
        let stated = json!({"measure": "crosshead_acceleration", "range": range, "bits": 8});
        tree["sensors"] = json!([stated]);
        sensor_section::write(&mut tree, &found, rate).unwrap();
        let machine = MachineFile::from_tree(&tree).unwrap().resolve().unwrap();
        let chain = &machine.sensors[0].chain;
        assert_eq!(chain.bits, Some(expected.1), "{range}");
        let Some(simulate::Range::Fixed(written)) = chain.range else {
            panic!("{chain:?}");
        };
        match expected.0.is_nan() {
            true => assert!(written > 1e5, "{range}: {written}"),
            false => assert_eq!(written, expected.0),
        }
    }
}

/// A step that all runs have, over an assumed range.
fn step_is(converter: &Converter, expected: f64) {
    let Converter::RangeAssumed {
        resolution,
        bits,
        range,
        ..
    } = *converter
    else {
        panic!("{converter:?}");
    };
    near(Some(resolution), expected, 1e-3);
    assert_eq!(bits, ASSUMED_BITS);
    near(
        Some(2.0 * range / f64::from(bits).exp2()),
        resolution,
        1e-12,
    );
}
