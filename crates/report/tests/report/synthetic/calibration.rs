//! A made-up calibration: two joints, five runs, one of them held out.

use super::Uniform;
use report::calibration_page::{
    Bounded, CalibrationPage, Channel, Estimate, Forecast, Hypothesis, Misfit, OrderResidual,
    Point, Run, Transfer,
};
use std::f64::consts::TAU;

/// The page of it.
pub fn page() -> CalibrationPage {
    let mut random = Uniform(7);
    let runs: Vec<Run> = (1..=5).map(|i| run(i, &mut random)).collect();
    let parameters = vec![
        estimate("joints.big_end.contact.stiffness", 2.4e10, 0.79, Some(0.03)),
        estimate("joints.big_end.contact.damping", 2e4, 0.81, Some(0.12)),
        estimate("joints.big_end.friction.coefficient", 0.05, 1.0, None),
        estimate("joints.small_end.contact.stiffness", 2e10, 1.34, Some(0.05)),
        estimate("joints.small_end.contact.damping", 2e4, 1.38, Some(0.2)),
        estimate("cylinder.head_clearance", 0.024, 1.001, Some(0.002)),
    ];
    let correlation = |i: usize, j: usize| match (i, j) {
        _ if i == j => 1.0,
        (2, _) | (_, 2) => 0.0,
        (0, 3) | (3, 0) => -0.94,
        _ => 0.9 - 0.4 * i.abs_diff(j) as f64,
    };
    let count = parameters.len();
    CalibrationPage {
        name: "single-stage compressor".into(),
        version: "1.0.0".into(),
        optimiser: "levenberg-marquardt, cma-es".into(),
        evaluations: 48,
        seconds: 13.2,
        complete: true,
        fitted: Misfit {
            before: 14.2,
            after: 1.04,
        },
        held_out: Some(Misfit {
            before: 15.8,
            after: 1.09,
        }),
        parameters,
        correlations: (0..count)
            .map(|i| (0..count).map(|j| correlation(i, j)).collect())
            .collect(),
        runs,
        transfer: Some(transfer()),
    }
}

fn estimate(path: &str, nominal: f64, factor: f64, half: Option<f64>) -> Estimate {
    let value = nominal * factor;
    let unit = match path.rsplit('.').next() {
        Some("stiffness") => "N/m^1.5",
        Some("damping") => "N s/m",
        Some("head_clearance") => "m",
        _ => "",
    };
    Estimate {
        path: path.into(),
        unit: unit.into(),
        nominal,
        value,
        interval: half.map(|half| [value * (1.0 - half), value * (1.0 + half)]),
        reason: String::new(),
    }
}

fn run(number: usize, random: &mut Uniform) -> Run {
    let held_out = number == 4;
    let mut channel = |column: &str, size: f64, offset: f64| Channel {
        column: column.into(),
        waveform: (0..512)
            .map(|i| {
                let angle = TAU * i as f64 / 512.0;
                let ringing = 0.2 * (31.0 * angle).sin() * (-2.0 * angle).exp();
                let wave = offset + size * (angle.cos() + 0.2 * (2.0 * angle).cos() + ringing);
                let noise = size * 0.005;
                Point {
                    crank_angle_deg: 360.0 * i as f64 / 512.0,
                    measured: wave + 1.7 * noise * (random.next() - 0.5),
                    scatter: size * 0.03,
                    noise,
                    before: wave + size * (0.05 * (3.0 * angle).sin() + 0.5 * ringing),
                    after: wave,
                }
            })
            .collect(),
        orders: (usize::from(offset == 0.0)..=80)
            .map(|order| OrderResidual {
                order: order as f64,
                before: 20.0 * random.next() / (1.0 + 0.03 * order as f64),
                after: 0.2 + 1.5 * random.next(),
            })
            .collect(),
    };
    Run {
        id: format!("run{number:02}"),
        held_out,
        misfit: Misfit {
            before: 11.0 + number as f64,
            after: 1.0 + 0.02 * number as f64,
        },
        channels: vec![
            channel("crosshead_acceleration_m_s2", 240.0, 0.0),
            channel("cylinder_pressure_pa", 1.2e5, 2.5e5),
        ],
    }
}

fn transfer() -> Transfer {
    let relations = ["eq5", "conformal", "constant"];
    let states = ["joints.big_end", "joints.small_end"].map(|joint| vec![(joint.into(), 3e-4)]);
    let forecast = |run: &str, i: usize, clearances: &Vec<(String, f64)>| {
        let value = 480.0 + 60.0 * i as f64;
        let peak = Bounded {
            value,
            interval: Some([value - 15.0, value + 15.0]),
        };
        Forecast {
            run: run.into(),
            relation: relations[i].into(),
            clearances: clearances.clone(),
            peaks: vec![("crosshead_acceleration_m_s2".into(), peak, None)],
        }
    };
    Transfer {
        left: Vec::new(),
        by_held_out: false,
        relations: relations
            .iter()
            .map(|relation| Hypothesis {
                relation: (*relation).into(),
                fitted: 1.04,
                held_out: Some(1.09),
                ..Hypothesis::default()
            })
            .collect(),
        forecasts: states
            .iter()
            .flat_map(|state| (0..3).map(move |i| (state, i)))
            .flat_map(|(state, i)| ["run01", "run02"].map(|run| forecast(run, i, state)))
            .collect(),
    }
}
