//! A force outside the catalogue, hidden in the predicted lines of a machine with a loose crosshead
//! pin, is found or the gap stays unexplained.

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
#[ignore]
fn experiment() {
    let hidden: Value = serde_json::from_str(&std::env::var("HIDDEN").unwrap()).unwrap();
    let runs = recorded(&hidden, 1);
    let problem = problem(machine(&json!([])), runs);
    let effort = Effort::new(&problem, vec!["d".into()], 120, gap::Journal::default()).unwrap();
    let watch = || ControlFlow::Continue(());
    let model = Model::fit(problem.clone(), &[0.0; 3], &effort, &watch).unwrap();
    eprintln!(
        "baseline {:.2} {:?} {:?}",
        model.fitted, model.held_out, model.x
    );
    let start = std::time::Instant::now();
    let law = empirical_force(&model, &effort, &watch, &|words, misfit| {
        if std::env::var("SAY").is_ok() {
            eprintln!("{words} {misfit:.2}")
        }
    })
    .unwrap();
    let force = law.unwrap();
    for m in &force.missing {
        eprintln!(
            "{} {:.0?}",
            m.run,
            m.force.iter().step_by(6).collect::<Vec<_>>()
        );
    }
    let Some(law) = force.law else {
        eprintln!("none");
        return;
    };
    eprintln!(
        "{:.1?}: {:.3} {:?} {:?}",
        start.elapsed(),
        law.model.fitted,
        law.model.held_out,
        law.model.x
    );
    for p in law.model.problem.parameters.iter().zip(&law.model.x) {
        eprintln!("{} {:.4}", p.0.path, p.0.value(*p.1));
    }
}
