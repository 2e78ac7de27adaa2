use calibrate::likelihood::*;
use calibrate::observation::*;
use calibrate::optimiser::*;
use calibrate::parameter::Parameter;
use calibrate::problem::*;
use calibrate::*;
use std::ops::ControlFlow;
use std::time::Instant;
fn main() {
    let dir = std::env::args().nth(1).unwrap();
    let index: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(format!("{dir}/index.json")).unwrap())
            .unwrap();
    let file =
        input::machine_file::read(std::path::Path::new("data/machines/single-stage.yaml")).unwrap();
    let tree = file.to_tree().clone();
    let names: Vec<String> = ["crosshead_acceleration_m_s2", "cylinder_pressure_pa"]
        .map(String::from)
        .to_vec();
    let read = |path: String| -> Vec<f64> {
        std::fs::read(path)
            .unwrap()
            .chunks_exact(4)
            .map(|c| f64::from(f32::from_le_bytes(c.try_into().unwrap())))
            .collect()
    };
    let runs: Vec<Observation> = index
        .as_array()
        .unwrap()
        .iter()
        .map(|r| {
            let id = r["id"].as_str().unwrap();
            let settings = r["settings"]
                .as_array()
                .unwrap()
                .iter()
                .map(|p| (p[0].as_str().unwrap().to_owned(), p[1].clone()))
                .collect();
            let run = Run {
                id: id.into(),
                settings,
                speed_rpm: r["speed_rpm"].as_f64().unwrap(),
                sample_rate: r["sample_rate_hz"].as_f64().unwrap(),
                crank_angle: Some(read(format!("{dir}/{id}.crank_angle_rad"))),
                channels: names
                    .iter()
                    .map(|n| Channel {
                        column: n.clone(),
                        samples: read(format!("{dir}/{id}.{n}")),
                    })
                    .collect(),
            };
            Observation::of(&run, &names).unwrap()
        })
        .collect();
    for r in &runs {
        println!(
            "{} {:?}",
            r.id,
            r.channels
                .iter()
                .map(|c| (c.orders.len(), c.lines.amplitude.len(), c.lines.revolutions))
                .collect::<Vec<_>>()
        );
    }
    let mut t0 = tree.clone();
    for (p, v) in &runs[0].settings {
        input::paths::set(&mut t0, p, v.clone()).unwrap();
    }
    let paths = [
        "joints.big_end.contact.stiffness",
        "joints.small_end.contact.stiffness",
        "joints.big_end.contact.damping",
        "joints.small_end.contact.damping",
        "joints.big_end.friction.coefficient",
        "joints.small_end.friction.coefficient",
    ];
    let parameters = paths
        .iter()
        .map(|p| Parameter::of(&t0, p).unwrap())
        .collect();
    let problem = Problem {
        tree,
        parameters,
        runs,
    };
    let l = Likelihood::new(&problem);
    let t = Instant::now();
    let x = vec![0.0; 6];
    println!(
        "nominal by run {:?} {:?}",
        l.by_run(&x)
            .unwrap()
            .iter()
            .map(|r| misfit(r))
            .collect::<Vec<_>>(),
        t.elapsed()
    );
    if let Some(truth) = index[0]["truth"].as_array() {
        let x: Vec<f64> = problem
            .parameters
            .iter()
            .zip(truth)
            .map(|(p, v)| p.coordinate(v.as_f64().unwrap()))
            .collect();
        println!(
            "truth {x:.4?} by run {:?}",
            l.by_run(&x)
                .unwrap()
                .iter()
                .map(|r| misfit(r))
                .collect::<Vec<_>>()
        );
    }
    let t = Instant::now();
    let j = l.jacobian(&x);
    println!("jacobian {:?} {:?}", j.shape(), t.elapsed());
    let found = levenberg_marquardt(&l, &x, 400, &mut |p| {
        println!(
            "  {:.3} {:.3?} {}",
            (2.0 * p.cost / l.count() as f64).sqrt(),
            p.x,
            p.evaluations
        );
        ControlFlow::Continue(())
    })
    .unwrap();
    let j = l.jacobian(&found.x);
    let cov = (j.transpose() * &j).try_inverse().unwrap();
    println!(
        "{:?}: {:.4?} ± {:.4?}",
        t.elapsed(),
        found.x,
        (0..6).map(|i| cov[(i, i)].sqrt()).collect::<Vec<_>>()
    );
    println!(
        "by run {:?}",
        l.by_run(&found.x)
            .unwrap()
            .iter()
            .map(|r| misfit(r))
            .collect::<Vec<_>>()
    );
}
