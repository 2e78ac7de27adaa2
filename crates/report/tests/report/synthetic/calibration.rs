//! A made-up calibration: two joints, five runs, one of them held out.

use super::Uniform;
use report::calibration_page::{
    Bounded, CalibrationPage, Chamber, Channel, Converter, Diagram, Estimate, Forecast, Hypothesis,
    Known, Misfit, Noise, OrderResidual, Phase, Point, Pressure, Run, Sensor, Transfer,
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
        complete: true,
        adequate: true,
        corrections: Vec::new(),
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
        sensors: vec![Sensor {
            column: "crosshead_acceleration_m_s2".into(),
            noise: Noise::Known {
                rms: 4.78,
                of_signal: Some(0.02),
                pink_share: 0.3,
            },
            converter: Converter::RangeAssumed {
                resolution: 0.0625,
                bits_needed: 14,
                bits: 24,
                range: 524_288.0,
            },
            sample_rate_hz: Some(20_000.0),
        }],
        gas: vec![chamber()],
        transfer: Some(transfer()),
    }
}

/// A double-acting cylinder's head end whose suction valve closes 70° late.
fn chamber() -> Chamber {
    let points = (0..720).map(|i| {
        let angle = f64::from(i) / 2.0;
        let distance = 0.047 + 0.16 * (1.0 - angle.to_radians().cos());
        let gas = |enclosed: f64| (1.7 * (enclosed / distance).powf(1.3)).clamp(1.7, 3.0);
        let pressure = |closes: f64, enclosed: f64| match angle {
            a if a < 180.0 => gas(0.047 * (3.0_f64 / 1.7).powf(1.0 / 1.3)),
            a if a < closes => 1.7,
            _ => gas(enclosed),
        };
        Pressure {
            crank_angle_deg: angle,
            distance_m: [distance, 1.1 * distance],
            measured_pa: 1e6 * pressure(250.0, 0.26),
            simulated_pa: [1e6 * pressure(180.0, 0.367), 1e6 * pressure(180.0, 0.35)],
        }
    });
    let events = |closes: f64| {
        [
            ("suction_opens", 30.0),
            ("suction_closes", closes),
            ("discharge_opens", 290.0),
        ]
        .map(|(name, angle)| (name.to_owned(), angle, [angle - 2.0, angle + 3.0]))
        .to_vec()
    };
    let diagram = |closes: f64| Diagram {
        clearance: 0.147,
        exponents: [1.3, 1.3],
        polytropes: [[260.0, 285.0], [4.0, 25.0]],
        events: events(closes),
        alternatives: vec![(0.1, [1.2, 1.0], 0.004), (0.18, [1.4, 1.667], 0.005)],
    };
    Chamber {
        run: "run1".into(),
        column: "cylinder_pressure_pa".into(),
        rms_pa: Misfit {
            before: 3e5,
            after: 1.5e5,
        },
        phases: vec![Phase {
            name: "compression".into(),
            crank_angle_deg: [250.0, 290.0],
            rms_pa: 3.4e5,
            share: 0.62,
        }],
        measured: Some(diagram(250.0)),
        calibrated: Some(diagram(180.0)),
        points: points.collect(),
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
        known: half.map_or(Known::Nothing, |half| {
            Known::Within([value * (1.0 - half), value * (1.0 + half)])
        }),
        ..Estimate::default()
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
