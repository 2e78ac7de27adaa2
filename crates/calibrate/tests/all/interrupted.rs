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

/// Interrupts a search of `evaluations`: its user stops it after each of `stops` evaluations, and it is killed where
/// each of these shares of its checkpoint is written.
fn ends_where_it_would_have_ended(
    optimiser: Optimiser,
    evaluations: u64,
    stops: &[u64],
    kills: &[f64],
) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint.bin");
    let problem = problem();
    let fitted = |most: Option<u64>| {
        let checkpoint = Checkpoint::open(&path, "of this", false).unwrap();
        let problem = Problem {
            meter: Meter::with_checkpoint(checkpoint),
            ..problem.clone()
        };
        let settings = FitSettings {
            optimiser,
            seed: 3,
            evaluations,
            held_out: Vec::new(),
            start: None,
        };
        let watch = |progress: &Progress| match most {
            Some(most) if progress.evaluations >= most => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        calibrate(&problem, &settings, watch).unwrap()
    };
    let whole = format!("{:?}", fitted(None));
    let evaluated = fs::read(&path).unwrap();
    for most in stops {
        fs::remove_file(&path).unwrap();
        let stopped = fitted(Some(*most));
        assert!(!stopped.complete, "{optimiser:?}");
        assert_eq!(format!("{:?}", fitted(None)), whole);
    }
    for share in kills {
        let kept = (share * evaluated.len() as f64) as usize;
        fs::write(&path, &evaluated[..kept]).unwrap();
        assert_eq!(format!("{:?}", fitted(None)), whole);
    }
}

/// The default search is killed and stopped in `cli/tests/all/calibrate/ends.rs`.
#[test]
fn a_random_search_ends_where_it_would_have_ended() {
    // The first half of the checkpoint ends after the first generation.
    let few = Genetic {
        population: 6,
        ..Genetic::default()
    };
    for optimiser in [Optimiser::CmaEs, Optimiser::Genetic(few)] {
        ends_where_it_would_have_ended(optimiser, 16, &[], &[0.5]);
    }
}

#[test]
#[ignore = "minutes: tests/nightly/run calibrations"]
fn it_ends_where_it_would_have_ended() {
    for optimiser in [
        Optimiser::Default,
        Optimiser::FirstDescent,
        Optimiser::CmaEs,
        Optimiser::Genetic(Genetic::default()),
        Optimiser::LevenbergMarquardt,
    ] {
        ends_where_it_would_have_ended(optimiser, 40, &[6], &[0.1, 0.5, 0.9]);
    }
}
