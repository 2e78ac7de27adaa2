//! A search that was interrupted anywhere, whatever the optimiser, ends where it would have ended.

use crate::own_recordings;
use calibrate::checkpoint::Checkpoint;
use calibrate::fit::{FitSettings, Optimiser};
use calibrate::meter::Meter;
use calibrate::optimiser::{Genetic, Progress};
use calibrate::{Problem, calibrate};
use std::fs;
use std::ops::ControlFlow;

const TRUTH: [(&str, f64); 2] = [
    ("joints.small_end.contact.stiffness", -0.3),
    ("joints.small_end.contact.damping", 0.2),
];

/// A machine with a worn small end, and what it shows itself over two runs.
fn problem() -> Problem {
    let tree = own_recordings::machine(["ideal", "0.1 mm"]);
    own_recordings::problem(tree, &TRUTH, &[380.0, 480.0], 60, 1e-4)
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
