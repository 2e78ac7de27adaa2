//! Machines that are drawn here, and their recordings.
//!
//! A machine has one throw or two. The file states a healthy machine: big ends and small ends are clear, the others ideal;
//! contact parameters are those of a calibration, 1 % off. In the machine itself they lie between 0.6 and 1.4 times their nominal
//! values. None to four of its joints are worn, with 1.5 to 10 times their normal clearance. With one throw these are big end,
//! small end, guide and main bearing; with two, both ends of both rods. Joints that are not worn are as in the file, those that are
//! clear up to 20 % off.
//!
//! Worn joints follow the relation of the file, or, in every third case, another one: stiffness and damping change with the
//! clearance by other exponents. The recordings are the accelerations of the crossheads or of the frame, with or without the
//! pressures of the cylinders, in one or two runs of different speed.

use super::case::{Case, WORN_FROM, case, seen};
use crate::recording::{clean, noisy};
use calibrate::{Parameter, Relation};
use input::unit::{Dimension, Measure};
use input::{MachineFile, paths};
use rand::RngExt;
use rand::seq::IndexedRandom;
use scalar::random::{Purpose, Stream, stream};
use serde_json::{Value, json};
use simulate::{ChamberEnd, Measured};
use std::collections::BTreeMap;
use std::error::Error;

/// The machines of one throw and of two: names and contents of their files.
const MACHINES: [[&str; 2]; 2] = [
    [
        "single-stage.yaml",
        include_str!("../../../../data/machines/single-stage.yaml"),
    ],
    [
        "two-stage.yaml",
        include_str!("../../../../data/machines/two-stage.yaml"),
    ],
];
/// What of a contact is drawn.
const CONTACT: [&str; 3] = [
    "contact.stiffness",
    "contact.damping",
    "friction.coefficient",
];
/// The most joints that are worn, and their clearance over the normal one at most.
const MOST_WORN: usize = 4;
const MOST_TIMES: f64 = 10.0;
/// By how much the exponents of another relation differ from those of the file at most.
const EXPONENT: f64 = 0.1;
/// Draws of which one is a machine whose motion can be recorded.
const DRAWS: usize = 20;

/// A joint that may be worn.
struct Joint {
    path: String,
    /// Its normal clearance, m.
    normal: f64,
    /// Whether it is clear in the file.
    is_clear: bool,
}

/// The name of the case of this number.
pub fn name(seed: u64, number: u64) -> String {
    format!("own {seed}/{number}")
}

/// The case of this number, estimated.
///
/// # Errors
/// A machine that cannot be recorded in any of several draws, or an estimation that fails.
pub fn case_of(seed: u64, number: u64) -> Result<Case, Box<dyn Error>> {
    let Drawn {
        file, runs, truth, ..
    } = drawn(seed, number)?;
    case(name(seed, number), file, runs, truth)
}

/// One line on the case of this number: its worn joints, its runs, whether their motion repeats itself, and the misfit that
/// the true machine leaves.
///
/// # Errors
/// A machine that cannot be recorded in any of several draws.
pub fn described(seed: u64, number: u64) -> Result<String, Box<dyn Error>> {
    let drawn = drawn(seed, number)?;
    let name = name(seed, number);
    let worn = drawn
        .truth
        .iter()
        .map(|(joint, c)| format!("{joint} {:.3} mm", c * 1e3));
    let worn: Vec<String> = worn.collect();
    let channels: Vec<&str> = drawn.runs[0]
        .channels
        .iter()
        .map(|c| c.column.as_str())
        .collect();
    let (misfit, repeat) = seen(&drawn.machine, &drawn.runs)?;
    let of_runs: Vec<&str> = repeat
        .iter()
        .map(|r| if *r { "repeats" } else { "scatters" })
        .collect();
    Ok(format!(
        "{name}: {}; {}; {}; true machine {misfit:.2}",
        worn.join(", "),
        channels.join(", "),
        of_runs.join(", ")
    ))
}

/// The machine of this number and its recordings, from the first draw that can be recorded.
fn drawn(seed: u64, number: u64) -> Result<Drawn, Box<dyn Error>> {
    let mut random = stream(seed, number, Purpose::Variation);
    let mut last = None;
    for _ in 0..DRAWS {
        match draw(&mut random, seed, number) {
            Ok(drawn) => return Ok(drawn),
            Err(error) => last = Some(error),
        }
    }
    Err(last.unwrap_or_else(|| "nothing was drawn".into()))
}

/// What is drawn for a case.
struct Drawn {
    file: Value,
    machine: Value,
    runs: Vec<calibrate::Run>,
    truth: BTreeMap<String, f64>,
}

fn draw(random: &mut Stream, seed: u64, number: u64) -> Result<Drawn, Box<dyn Error>> {
    // Numbers of worn joints and places of the sensor take turns.
    let worn = number as usize % (MOST_WORN + 1);
    let on_crosshead = number.is_multiple_of(2);
    let throws = random.random_range(1..=2_usize);
    let mut tree = healthy(throws)?;
    let joints = joints(&tree, throws)?;
    let speed = Parameter::at(&tree, "speed")?.nominal;
    let file = contacts(random, &mut tree, &joints)?;
    let truth = clearances(random, &joints, worn);
    if number.is_multiple_of(3) {
        another_relation(random, &mut tree, &joints, &truth)?;
    }
    for (joint, clearance) in truth.iter().filter(|(_, clearance)| **clearance > 0.0) {
        set(&mut tree, &format!("{joint}.clearance"), *clearance)?;
    }
    let mut measured = match on_crosshead {
        true => (0..throws)
            .map(|throw| Measured::CrossheadAcceleration { throw })
            .collect(),
        false => frame(&tree)?,
    };
    if random.random_bool(0.5) {
        let end = ChamberEnd::Head;
        measured.extend((0..throws).map(|throw| Measured::CylinderPressure { throw, end }));
    }
    let mut runs = Vec::new();
    for i in 0..random.random_range(1..=2_u64) {
        let rpm = speed * 30.0 / std::f64::consts::PI * random.random_range(0.7..1.3);
        let speed = json!(format!("{rpm:.1} rpm"));
        let settings = vec![("speed".to_owned(), speed.clone())];
        let mut tree = tree.clone();
        paths::set(&mut tree, "speed", speed)?;
        let clean = clean(&format!("run{}", i + 1), &settings, &tree, &measured)?;
        runs.push(noisy(&clean, seed, 100 * number + i)?);
    }
    Ok(Drawn {
        file,
        machine: tree,
        runs,
        truth,
    })
}

/// The healthy machine of one throw or two, with its nominal contact parameters.
fn healthy(throws: usize) -> Result<Value, Box<dyn Error>> {
    let [name, text] = MACHINES[throws - 1];
    let mut tree = MachineFile::from_yaml(text, name)?.to_tree().clone();
    for joint in joints(&tree, throws)?.iter().filter(|joint| joint.is_clear) {
        let Joint { path, normal, .. } = joint;
        set(&mut tree, &format!("{path}.clearance"), *normal)?;
        set(&mut tree, &format!("{path}.contact.at_clearance"), *normal)?;
        let relation = json!(Relation::Equation5.name());
        paths::set(&mut tree, &format!("{path}.contact.relation"), relation)?;
    }
    Ok(tree)
}

/// The joints of the file that may be worn.
fn joints(tree: &Value, throws: usize) -> Result<Vec<Joint>, Box<dyn Error>> {
    let ends = ["big_end", "small_end"];
    let paths: Vec<(String, bool)> = match throws {
        1 => ["big_end", "small_end", "guide", "main"]
            .map(|joint| (format!("joints.{joint}"), ends.contains(&joint)))
            .into(),
        _ => ["throw1", "throw2"]
            .iter()
            .flat_map(|throw| ends.map(|end| (format!("throws.{throw}.joints.{end}"), true)))
            .collect(),
    };
    let joint = |(path, is_clear): (String, bool)| {
        let normal = Parameter::at(tree, &format!("{path}.normal_clearance"))?.nominal;
        Ok(Joint {
            path,
            normal,
            is_clear,
        })
    };
    paths.into_iter().map(joint).collect()
}

/// Draws the contact parameters of the machine `tree`, and returns its file, which has them 1 % off.
fn contacts(
    random: &mut Stream,
    tree: &mut Value,
    joints: &[Joint],
) -> Result<Value, Box<dyn Error>> {
    let mut file = tree.clone();
    for joint in joints {
        for key in CONTACT {
            let nominal = Parameter::at(tree, &format!("{}.{key}", joint.path))?;
            let truth = nominal.nominal * random.random_range(0.6..1.4);
            nominal.write(tree, truth)?;
            nominal.write(&mut file, truth * random.random_range(0.99..1.01))?;
        }
    }
    Ok(file)
}

/// The clearances of the worn machine, m; 0 for a joint that is ideal.
fn clearances(random: &mut Stream, joints: &[Joint], worn: usize) -> BTreeMap<String, f64> {
    let all: Vec<usize> = (0..joints.len()).collect();
    let worn: Vec<usize> = all.sample(random, worn).copied().collect();
    let of = |(i, joint): (usize, &Joint)| {
        let times = match worn.contains(&i) {
            true => random.random_range(WORN_FROM.ln()..MOST_TIMES.ln()).exp(),
            false if joint.is_clear => random.random_range(0.8..1.2),
            false => 0.0,
        };
        (joint.path.clone(), times * joint.normal)
    };
    joints.iter().enumerate().map(of).collect()
}

/// Gives the worn joints that are clear in the file stiffness and damping that follow their clearance by other exponents.
fn another_relation(
    random: &mut Stream,
    tree: &mut Value,
    joints: &[Joint],
    truth: &BTreeMap<String, f64>,
) -> Result<(), Box<dyn Error>> {
    for joint in joints.iter().filter(|joint| joint.is_clear) {
        let times = truth.get(&joint.path).map_or(1.0, |c| c / joint.normal);
        for key in &CONTACT[..2] {
            let parameter = Parameter::at(tree, &format!("{}.{key}", joint.path))?;
            let factor = times.powf(random.random_range(-EXPONENT..EXPONENT));
            parameter.write(tree, parameter.nominal * factor)?;
        }
    }
    Ok(())
}

/// The acceleration of the frame that the machine has a sensor for.
fn frame(tree: &Value) -> Result<Vec<Measured>, Box<dyn Error>> {
    let machine = MachineFile::from_tree(tree)?.resolve()?;
    let measured = machine.sensors.iter().map(|sensor| sensor.measured);
    let of_frame =
        measured.filter(|measured| measured.column(&[""]).contains("frame_acceleration"));
    Ok(of_frame.collect())
}

fn set(tree: &mut Value, path: &str, si: f64) -> Result<(), input::Error> {
    let dimension = Dimension::new(1.0, 0.0, 0.0, 0.0);
    paths::set(tree, path, json!(Measure { si, dimension }.to_string()))
}
