//! A search that was interrupted anywhere, whatever the optimiser, ends where it would have ended.

use calibrate::checkpoint::Checkpoint;
use calibrate::fit::{FitSettings, Optimiser};
use calibrate::meter::Meter;
use calibrate::observation::Observed;
use calibrate::optimiser::{Genetic, Progress};
use calibrate::prediction::predict;
use calibrate::{CrankMotion, Observation, Parameter, Problem, calibrate};
use mechanism::drive::GivenSpeed;
use serde_json::json;
use signal::order_lines::OrderLines;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

const TRUTH: [(&str, f64); 2] = [
    ("joints.small_end.contact.stiffness", -0.3),
    ("joints.small_end.contact.damping", 0.2),
];

/// A machine with a worn small end, and what it shows itself over two runs.
fn problem() -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let mut tree = input::machine_file::read(&path).unwrap().to_tree().clone();
    tree["joints"]["big_end"]["clearance"] = json!("ideal");
    tree["joints"]["small_end"]["clearance"] = json!("0.1 mm");
    let of = |(path, _): &(&str, f64)| Parameter::of(&tree, path).unwrap();
    let mut problem = Problem {
        parameters: TRUTH.iter().map(of).collect(),
        tree,
        runs: Vec::new(),
        crank: CrankMotion::Driven,
        meter: Meter::default(),
    };
    let observed = |lines| Observed {
        column: "crosshead_acceleration_m_s2".into(),
        lines,
        orders: (1..=60).collect(),
    };
    for speed in [40.0, 50.0] {
        let mut run = Observation {
            id: format!("{speed} rad/s"),
            settings: vec![("speed".to_owned(), json!(format!("{speed} rad/s")))],
            crank: GivenSpeed {
                speed,
                fluctuation: Vec::new(),
            },
            channels: vec![observed(OrderLines {
                amplitude: Vec::new(),
                variance: Vec::new(),
                revolutions: 30,
            })],
        };
        let shown = predict(&problem, &run, &TRUTH.map(|(_, x)| x)).unwrap();
        let lines = shown.lines.into_iter().next().unwrap();
        run.channels = vec![observed(OrderLines {
            variance: vec![1e-4; lines.amplitude.len()],
            revolutions: 30,
            ..lines
        })];
        problem.runs.push(run);
    }
    problem
}

#[test]
fn it_ends_where_it_would_have_ended() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint.bin");
    let fitted = |optimiser, most: Option<u64>| {
        let mut problem = problem();
        let checkpoint = Checkpoint::open(&path, "of this", false).unwrap();
        problem.meter = Meter::with_checkpoint(checkpoint);
        let settings = FitSettings {
            optimiser,
            seed: 3,
            evaluations: 40,
            held_out: Vec::new(),
            start: None,
        };
        let watch = |progress: &Progress| match most {
            Some(most) if progress.evaluations >= most => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        calibrate(&problem, &settings, watch).unwrap()
    };
    for optimiser in [
        Optimiser::Default,
        Optimiser::FirstDescent,
        Optimiser::CmaEs,
        Optimiser::Genetic(Genetic::default()),
        Optimiser::LevenbergMarquardt,
    ] {
        let whole = format!("{:?}", fitted(optimiser, None));
        let evaluated = fs::read(&path).unwrap();
        // Stopped by its user.
        fs::remove_file(&path).unwrap();
        let stopped = fitted(optimiser, Some(6));
        assert!(!stopped.complete, "{optimiser:?}");
        assert_eq!(format!("{:?}", fitted(optimiser, None)), whole);
        // Killed at any byte.
        for share in [0.1, 0.5, 0.9] {
            let kept = (share * evaluated.len() as f64) as usize;
            fs::write(&path, &evaluated[..kept]).unwrap();
            assert_eq!(format!("{:?}", fitted(optimiser, None)), whole);
        }
        fs::remove_file(&path).unwrap();
    }
}
