//! Derivatives of predictions of a free crank against differences: its period moves with the machine.

use calibrate::meter::Meter;
use calibrate::observation::Observed;
use calibrate::prediction::{predict, predict_with_derivatives};
use calibrate::{CrankMotion, Observation, Parameter, Problem};
use input::{MachineFile, machine_file, paths};
use signal::order_lines::OrderLines;
use std::path::Path;

const COLUMNS: [&str; 2] = ["crosshead_acceleration_m_s2", "cylinder_pressure_pa"];
const ORDERS: usize = 60;

/// The shipped machine with a light flywheel and 0.1 mm at the small end.
fn problem(paths_of_parameters: &[&str]) -> Problem {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let file = machine_file::read(Path::new(path)).unwrap();
    let mut tree = file.to_tree().clone();
    let free =
        serde_json::json!({"inertia": "8 kg m^2", "mean_torque": "60 N m", "slope": "1000 N m s"});
    for (path, value) in [
        ("crank.drive", serde_json::json!({ "free": free })),
        ("joints.small_end.clearance", "0.1 mm".into()),
    ] {
        paths::set(&mut tree, path, value).unwrap();
    }
    MachineFile::from_tree(&tree).unwrap().resolve().unwrap();
    let parameters = paths_of_parameters.iter();
    let parameters = parameters.map(|path| Parameter::at(&tree, path).unwrap());
    Problem {
        parameters: parameters.collect(),
        tree,
        runs: Vec::new(),
        crank: CrankMotion::Driven,
        meter: Meter::default(),
    }
}

fn run() -> Observation {
    let observed = |column: &str| Observed {
        scatter: Vec::new(),
        column: column.into(),
        orders: (1..=ORDERS).collect(),
        lines: OrderLines {
            amplitude: Vec::new(),
            variance: Vec::new(),
            revolutions: 30,
        },
    };
    Observation {
        id: "run01".into(),
        settings: Vec::new(),
        crank: mechanism::drive::GivenSpeed {
            speed: 0.0,
            fluctuation: Vec::new(),
        },
        channels: COLUMNS.map(observed).into(),
        warm_start: None,
    }
}

#[test]
fn derivatives_of_a_free_crank_equal_differences() {
    let parameters = [
        "crosshead.mass",
        "cylinder.exponent",
        "joints.small_end.contact.stiffness",
    ];
    let (problem, run) = (problem(&parameters), run());
    let centre = [0.0; 3];
    let found = predict_with_derivatives(&problem, &run, &centre).unwrap();
    assert!(found.periodic);
    // Wide enough for the predictions' own accuracy.
    let step = 3e-3;
    for (i, path) in parameters.iter().enumerate() {
        let at = |by: f64| {
            let mut x = centre;
            x[i] += by;
            predict(&problem, &run, &x).unwrap()
        };
        let (more, less) = (at(step), at(-step));
        for (channel, column) in COLUMNS.iter().enumerate() {
            let [mut apart, mut size] = [0.0, 0.0];
            for k in 1..=ORDERS {
                let difference =
                    more.lines[channel].amplitude[k] - less.lines[channel].amplitude[k];
                let expected = difference / (2.0 * step);
                apart += (found.derivatives[i][channel][k] - expected).norm_sqr();
                size += expected.norm_sqr();
            }
            let apart = (apart / size).sqrt();
            assert!(apart < 0.02, "{path} in {column}: {apart:.1e}");
        }
    }
}
