//! A made-up calibration: two joints, five runs, one of them held out.

use super::Uniform;
use calibrate::Bounded;
use calibrate::Relation;
use calibrate::converter::Converter;
use calibrate::forecast::{ChannelForecast, Forecast};
use calibrate::recorded_sensor::{RecordedNoise, RecordedSensor};
use calibrate::results::{
    self, Alternative, ByName, Diagram, Estimate, Event, Gas, Misfits, Phase, Polytrope, Relations,
    Results, Rms, ValveEvents,
};
use calibrate::transfer::{Basis, Decision, Hypothesis};
use report::calibration_page::{
    CalibrationPage, Channel, Misfit, OrderResidual, Point, Pressure, Run,
};
use std::f64::consts::TAU;

/// The page of it.
pub fn page() -> CalibrationPage {
    let mut random = Uniform(7);
    let runs: Vec<Run> = (1..=5).map(|i| run(i, &mut random)).collect();
    let parameters = [
        estimate("joints.big_end.contact.stiffness", 2.4e10, 0.79, Some(0.03)),
        estimate("joints.big_end.contact.damping", 2e4, 0.81, Some(0.12)),
        estimate("joints.big_end.friction.coefficient", 0.05, 1.0, None),
        estimate("joints.small_end.contact.stiffness", 2e10, 1.34, Some(0.05)),
        estimate("joints.small_end.contact.damping", 2e4, 1.38, Some(0.2)),
        estimate("cylinder.head_clearance", 0.024, 1.001, Some(0.002)),
    ];
    let correlation = |i: usize, j: usize| match (i, j) {
        (2, _) | (_, 2) => 0.0,
        (0, 3) | (3, 0) => -0.94,
        _ => 0.9 - 0.4 * i.abs_diff(j) as f64,
    };
    let names = || parameters.iter().map(|(path, _)| path.clone()).enumerate();
    let row = |i: usize| {
        names()
            .map(move |(j, other)| (other, correlation(i, j)))
            .collect()
    };
    let units = ["N/m^1.5", "N s/m", "", "N/m^1.5", "N s/m", "m"];
    let misfits = |run: &Run| {
        let misfits = results::Run {
            held_out: run.held_out,
            nominal: run.misfit.before,
            calibrated: run.misfit.after,
        };
        (run.id.clone(), misfits)
    };
    let (relations, predictions) = transfer();
    let results = Results {
        optimiser: "levenberg-marquardt, cma-es".into(),
        evaluations: 48,
        complete: true,
        model_is_adequate: true,
        correlations: names().map(|(i, path)| (path, row(i))).collect(),
        fit: Misfits {
            nominal: Some(14.2),
            calibrated: Some(1.04),
            heldout_nominal: Some(15.8),
            heldout_calibrated: Some(1.09),
            ..Misfits::default()
        },
        runs: runs.iter().map(misfits).collect(),
        relations: Some(relations),
        predictions: Some(predictions),
        noise: [("crosshead_acceleration_m_s2".to_owned(), sensor())].into(),
        gas: Some(one("run1", one("cylinder_pressure_pa", gas()))),
        parameters: parameters.into_iter().collect(),
        ..Results::default()
    };
    let pressures = [("cylinder_pressure_pa".to_owned(), pressures())];
    CalibrationPage {
        name: "single-stage compressor".into(),
        version: "1.0.0".into(),
        results,
        units: units.map(str::to_owned).to_vec(),
        runs,
        pressures: [("run1".to_owned(), pressures.into())].into(),
    }
}

fn one<T>(name: &str, entry: T) -> ByName<T> {
    std::iter::once((name.to_owned(), entry)).collect()
}

fn sensor() -> RecordedSensor {
    RecordedSensor {
        noise: RecordedNoise {
            rms: Some(4.78),
            of_signal: Some(0.02),
            pink_share: Some(0.3),
            ..RecordedNoise::default()
        },
        converter: Converter::RangeAssumed {
            resolution: 0.0625,
            bits_needed: 14,
            bits: 24,
            range: 524_288.0,
        },
        sample_rate_hz: Some(20_000.0),
    }
}

/// The pressures of a double-acting cylinder's head end whose suction valve closes 70° late.
fn pressures() -> Vec<Pressure> {
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
    points.collect()
}

/// Their estimates.
fn gas() -> Gas {
    let event = |angle: f64| Event {
        crank_angle_deg: angle,
        low: angle - 2.0,
        high: angle + 3.0,
    };
    let polytrope = |crank_angle_deg| Polytrope {
        crank_angle_deg,
        exponent: 1.3,
        exponent_per_clearance_share: 5.0,
        scatter: 0.004,
    };
    let alternative =
        |clearance_share, compression_exponent, expansion_exponent, scatter| Alternative {
            clearance_share,
            compression_exponent,
            expansion_exponent,
            scatter,
        };
    let diagram = |closes: f64| Diagram {
        suction_pa: 1.7e6,
        discharge_pa: 3e6,
        clearance_share: 0.147,
        compression: polytrope([260.0, 285.0]),
        expansion: polytrope([4.0, 25.0]),
        alternatives: [
            alternative(0.1, 1.2, 1.0, 0.004),
            alternative(0.18, 1.4, 1.667, 0.005),
        ],
        valve_events: ValveEvents {
            suction_opens: event(30.0),
            suction_closes: event(closes),
            discharge_opens: event(290.0),
            discharge_closes: event(360.0),
        },
    };
    Gas {
        rms_pa: Rms {
            nominal: 3e5,
            calibrated: 1.5e5,
        },
        phases: vec![Phase {
            phase: "compression".into(),
            crank_angle_deg: [250.0, 290.0],
            rms_pa: 3.4e5,
            share: 0.62,
        }],
        measured: Some(diagram(250.0)),
        calibrated: Some(diagram(180.0)),
    }
}

fn estimate(path: &str, nominal: f64, factor: f64, half: Option<f64>) -> (String, Estimate) {
    let value = nominal * factor;
    let estimate = Estimate {
        value,
        low: half.map(|half| value * (1.0 - half)),
        high: half.map(|half| value * (1.0 + half)),
        nominal,
        identifiable: half.is_some(),
        at_bound: false,
        bounds: [0.1 * nominal, 10.0 * nominal],
        logarithmic: true,
    };
    (path.into(), estimate)
}

fn run(number: usize, random: &mut Uniform) -> Run {
    let held_out = number == 4;
    let mut channel = |column: &str, size: f64, offset: f64| Channel {
        steps: Vec::new(),
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

fn transfer() -> (Relations, Vec<Forecast>) {
    let relations = [Relation::Equation5, Relation::Conformal, Relation::Constant];
    let forecast = |run: &str, joint: &str, i: usize| {
        let value = 480.0 + 60.0 * i as f64;
        let shown = Bounded {
            value,
            low: value - 15.0,
            high: value + 15.0,
        };
        let channel = ChannelForecast {
            rms: shown,
            peak: shown,
            recorded: None,
            difference: None,
        };
        Forecast {
            run: run.into(),
            clearance_m: [(joint.to_owned(), 3e-4)].into(),
            relation: relations[i],
            recorded: false,
            misfit: None,
            failure: None,
            channels: [("crosshead_acceleration_m_s2".to_owned(), channel)].into(),
        }
    };
    let forecasts = ["joints.big_end", "joints.small_end"]
        .into_iter()
        .flat_map(|joint| (0..3).map(move |i| (joint, i)))
        .flat_map(|(joint, i)| ["run01", "run02"].map(|run| forecast(run, joint, i)));
    let compared = relations.map(|relation| Hypothesis {
        relation,
        exponents: [].into(),
        fitted: 1.04,
        held_out: Some(1.09),
        runs: [].into(),
        criterion: None,
    });
    let found = Relations {
        decision: Decision {
            relations: Vec::new(),
            runs: Basis::None,
        },
        compared: compared.to_vec(),
    };
    (found, forecasts.collect())
}
