//! Machines that are drawn here, and their recordings.
//!
//! The healthy machine is the single-stage compressor with big end and small end clear, and contact parameters between 0.6 and
//! 1.4 times their nominal values. Its file states them as a calibration finds them, 1 % off. In the worn machine one or more of the first two or
//! four joints have 2 to 8 times their normal clearance; the others are as in the file, up to 20 % off. Each has one or two
//! runs, crosshead or frame acceleration, with or without the pressure of the cylinder.

use super::case::{Case, case};
use crate::recording::{clean, noisy};
use calibrate::Relation;
use input::unit::{Dimension, Measure};
use input::{MachineFile, paths};
use rand::RngExt;
use scalar::random::{Purpose, Stream, stream};
use serde_json::{Value, json};
use simulate::{ChamberEnd, Measured};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

/// A joint with its normal clearance, m, and whether it is clear in the file.
type Joint = (&'static str, f64, bool);

/// The joints, of which the first so many may be worn. The others are ideal.
const JOINTS: [Joint; 4] = [
    ("joints.big_end", 3e-5, true),
    ("joints.small_end", 3e-5, true),
    ("joints.guide", 5e-5, false),
    ("joints.main", 4e-5, false),
];
/// What of a contact is drawn.
const CONTACT: [&str; 3] = [
    "contact.stiffness",
    "contact.damping",
    "friction.coefficient",
];
/// Draws of which one is a machine whose motion can be recorded.
const DRAWS: usize = 20;

/// The case of this number.
pub fn case_of(seed: u64, number: u64, joints: usize) -> Result<Case, Box<dyn Error>> {
    let mut random = stream(seed, number, Purpose::Variation);
    let mut last = None;
    for _ in 0..DRAWS {
        match drawn(&mut random, seed, number, &JOINTS[..joints]) {
            Ok(case) => return Ok(case),
            Err(error) => last = Some(error),
        }
    }
    Err(last.unwrap_or_else(|| "nothing was drawn".into()))
}

fn drawn(
    random: &mut Stream,
    seed: u64,
    number: u64,
    joints: &[Joint],
) -> Result<Case, Box<dyn Error>> {
    let (file, healthy) = machines(random, joints)?;
    let truth = clearances(random, joints);
    let mut worn = healthy;
    for (joint, clearance) in &truth {
        if *clearance > 0.0 {
            set(&mut worn, &format!("{joint}.clearance"), *clearance)?;
        }
    }
    let mut measured = match random.random_bool(0.5) {
        true => vec![Measured::CrossheadAcceleration { throw: 0 }],
        false => frame(&worn)?,
    };
    if random.random_bool(0.5) {
        let end = ChamberEnd::Head;
        measured.push(Measured::CylinderPressure { throw: 0, end });
    }
    let mut runs = Vec::new();
    for i in 0..random.random_range(1..=2_u64) {
        let speed = json!(format!("{:.1} rpm", random.random_range(350.0..650.0)));
        let settings = vec![("speed".to_owned(), speed.clone())];
        let mut tree = worn.clone();
        paths::set(&mut tree, "speed", speed)?;
        let clean = clean(&format!("run{}", i + 1), &settings, &tree, &measured)?;
        runs.push(noisy(&clean, seed, 100 * number + i)?);
    }
    case(format!("own {number}"), file, runs, truth)
}

/// The machine file and the machine itself, healthy.
fn machines(random: &mut Stream, joints: &[Joint]) -> Result<(Value, Value), Box<dyn Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let mut tree = input::machine_file::read(&path)?.to_tree().clone();
    for (joint, ..) in &JOINTS[joints.len()..] {
        paths::set(&mut tree, joint, json!("ideal"))?;
    }
    for (joint, normal, is_clear) in joints.iter().copied() {
        set(&mut tree, &format!("{joint}.normal_clearance"), normal)?;
        if is_clear {
            set(&mut tree, &format!("{joint}.clearance"), normal)?;
        }
        if joint != "joints.guide" {
            paths::set(
                &mut tree,
                &format!("{joint}.contact.relation"),
                json!(Relation::Equation5.name()),
            )?;
            set(&mut tree, &format!("{joint}.contact.at_clearance"), normal)?;
        }
    }
    let mut file = tree.clone();
    for path in joints
        .iter()
        .flat_map(|(joint, ..)| CONTACT.map(|key| format!("{joint}.{key}")))
    {
        let nominal = calibrate::Parameter::of(&tree, &path)?;
        let truth = nominal.nominal * random.random_range(0.6..1.4);
        nominal.write(&mut tree, truth)?;
        nominal.write(&mut file, truth * random.random_range(0.99..1.01))?;
    }
    Ok((file, tree))
}

/// The clearances of the worn machine, m; 0 for a joint that is ideal.
fn clearances(random: &mut Stream, joints: &[Joint]) -> BTreeMap<String, f64> {
    let count = random.random_range(1..=joints.len());
    let mut worn: Vec<usize> = (0..joints.len()).collect();
    while worn.len() > count {
        worn.remove(random.random_range(0..worn.len()));
    }
    let of = |(i, (joint, normal, is_clear)): (usize, Joint)| {
        let times = match worn.contains(&i) {
            true => random.random_range(2.0_f64.ln()..8.0_f64.ln()).exp(),
            false if is_clear => random.random_range(0.8..1.2),
            false => 0.0,
        };
        (joint.to_owned(), times * normal)
    };
    joints.iter().copied().enumerate().map(of).collect()
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
    let dimension = Dimension::of(1.0, 0.0, 0.0, 0.0);
    paths::set(tree, path, json!(Measure { si, dimension }.to_string()))
}
