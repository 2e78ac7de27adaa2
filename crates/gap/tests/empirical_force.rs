//! A force outside the catalogue, hidden in the lines of a machine with a loose crosshead pin, is
//! found with its law.

use calibrate::observation::Observed;
use calibrate::prediction::predict;
use calibrate::{CrankMotion, Observation, Parameter, Problem};
use gap::{Effort, Model, empirical_force};
use mechanism::drive::GivenSpeed;
use rand::Rng;
use scalar::random::{Purpose, stream};
use serde_json::{Value, json};
use signal::order_lines::OrderLines;
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::path::Path;

const COLUMN: &str = "crosshead_acceleration_m_s2";
const ORDERS: usize = 60;
/// Standard deviation of a line's noise, m/s²: a few ten thousandths of the greatest line.
const NOISE: f64 = 0.15;
/// Runs: names, speeds and discharge pressures.
const RUNS: [(&str, f64, &str); 5] = [
    ("a", 350.0, "0.4 MPa"),
    ("b", 600.0, "0.4 MPa"),
    ("c", 480.0, "0.3 MPa"),
    ("d", 420.0, "0.5 MPa"),
    ("e", 540.0, "0.35 MPa"),
];

/// The single-stage machine with 0.1 mm at the small end.
fn machine(effects: &Value) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let machine = input::machine_file::read(&path).unwrap();
    let mut tree = machine.to_tree().clone();
    tree["effects"] = effects.clone();
    tree["joints"]["big_end"]["clearance"] = json!("ideal");
    tree["joints"]["small_end"]["clearance"] = json!("0.1 mm");
    tree
}

fn problem(tree: Value, runs: Vec<Observation>) -> Problem {
    let of = |key: &str| {
        let path = format!("joints.small_end.{key}");
        Parameter::of(&tree, &path).unwrap()
    };
    let parameters = [
        "contact.stiffness",
        "contact.damping",
        "friction.coefficient",
    ];
    Problem {
        parameters: parameters.map(of).to_vec(),
        tree,
        runs,
        crank: CrankMotion::Driven,
    }
}

/// What the machine with these effects, and contacts that are not as believed, shows with noise.
fn recorded(effects: &Value, seed: u64) -> Vec<Observation> {
    let truth = problem(machine(effects), Vec::new());
    let x = [0.2, -0.3, 0.4];
    let each = RUNS
        .iter()
        .enumerate()
        .map(|(index, (id, rpm, discharge))| {
            let observed = |lines| Observed {
                column: COLUMN.into(),
                lines,
                orders: (1..=ORDERS).collect(),
            };
            let mut run = Observation {
                id: (*id).into(),
                settings: vec![
                    ("speed".to_owned(), json!(format!("{rpm} rpm"))),
                    ("cylinder.discharge".to_owned(), json!(discharge)),
                ],
                crank: GivenSpeed {
                    speed: rpm * PI / 30.0,
                    fluctuation: Vec::new(),
                },
                channels: vec![observed(OrderLines {
                    amplitude: Vec::new(),
                    variance: Vec::new(),
                    revolutions: 30,
                })],
            };
            let shown = predict(&truth, &run, &x).unwrap();
            assert!(shown.periodic, "{id}");
            let mut lines = shown.lines.into_iter().next().unwrap();
            let mut numbers = stream(seed, index as u64, Purpose::Noise);
            // Uniform, with the standard deviation of the noise in both parts together.
            let mut noise = || {
                let even = f64::from(numbers.next_u32()) / f64::from(u32::MAX) - 0.5;
                NOISE * 6_f64.sqrt() * even
            };
            for c in &mut lines.amplitude {
                c.re += noise();
                c.im += noise();
            }
            run.channels = vec![observed(OrderLines {
                variance: vec![NOISE * NOISE; lines.amplitude.len()],
                revolutions: 30,
                ..lines
            })];
            run
        });
    each.collect()
}

#[test]
#[ignore = "takes some minutes without optimisation"]
fn a_force_of_no_effect_is_found_with_its_law() {
    let hidden = json!([{"empirical_force": {"velocity_sign": "-200 N"}}]);
    let problem = problem(machine(&json!([])), recorded(&hidden, 1));
    let effort = Effort {
        held_out: vec!["d".into()],
        evaluations: 120,
        chaotic: false,
        journal: gap::Journal::default(),
    };
    let watch = || ControlFlow::Continue(());
    let nominal = vec![0.0; problem.parameters.len()];
    let model = Model::fit(problem, &nominal, &effort, &watch).unwrap();
    assert!(model.fitted > 10.0, "{}", model.fitted);
    let found = empirical_force(&model, &effort, &watch, &|_, _| ()).unwrap();
    let found = found.unwrap();
    let law = found.law.unwrap();
    let keys: Vec<&str> = law.terms().map(|(key, _)| key).collect();
    assert_eq!(keys, ["velocity_sign"]);
    let (_, coefficient) = law.terms().next().unwrap();
    assert!((coefficient + 200.0).abs() < 1.0, "{coefficient}");
    for misfit in [law.model.fitted, law.model.held_out.unwrap()] {
        assert!((0.8..1.15).contains(&misfit), "{misfit}");
    }
    // Against the motion, which is away from the head in the first half of the revolution.
    for missing in &found.missing {
        assert!((missing.force[18] - 200.0).abs() < 30.0, "{missing:?}");
        assert!((missing.force[54] + 200.0).abs() < 30.0, "{missing:?}");
    }
}
