//! Made-up datasets: one on a grid of clearances, one drawn at random.

use super::{Recording, SAMPLE_RATE_HZ, SPEED_RPM, Uniform, recording, spectrum};
use classify::{Baseline, ClassScore, RankedFeature};
use recordings::FailedCase;
use report::Column;
use report::dataset_page::{DatasetPage, Design};
use std::f64::consts::TAU;
use study::Level;
use study::counts::{FaultCount, ParameterRange};
use study::examples::ClassExample;
use study::features::{Feature, FeatureRow};
use study::grid::{CaseLevel, ClearanceGrid, ClearanceGrids, JointSet};
use study::operation::{Operation, Waterfall};
use study::random::{Histogram, RandomSweep};
use study::recording::{Response, Spectrum};
use study::scatter::Scatter;

const FAULTS: [(&str, &[&str]); 4] = [
    ("none", &[]),
    ("big_end", &["big_end"]),
    ("small_end", &["small_end"]),
    ("big_end+small_end", &["big_end", "small_end"]),
];

/// Like the shipped sweep over three sets of joints and three clearances.
pub fn grid() -> DatasetPage {
    let set = |fault: usize| JointSet {
        joints: FAULTS[fault].0.to_owned(),
        responses: [1e-4, 2e-4, 3e-4]
            .into_iter()
            .enumerate()
            .map(|(i, clearance)| {
                (
                    clearance,
                    response(&made(fault, clearance, 8), 3 * fault + i - 2),
                )
            })
            .collect(),
    };
    let grid = ClearanceGrid {
        operating_point: "500 rpm".to_owned(),
        ideal: Some(response(&made(0, 0.0, 8), 0)),
        joint_sets: (1..4).map(set).collect(),
        high_from_hz: 160.0,
        levels: levels(),
        ..ClearanceGrid::default()
    };
    DatasetPage {
        name: "paper2".to_owned(),
        about: "The single-stage compressor of the clearance study: clearances of 0.1, 0.2 and 0.3 mm in the big end, the \
                small end and both, and the machine without clearance."
            .to_owned(),
        faults: counts([1, 3, 3, 3]),
        failed: Vec::new(),
        warnings: Vec::new(),
        ranges: vec![
            range("clearance of the big end", "m", 0.0, 3e-4, 4),
            range("clearance of the small end", "m", 0.0, 3e-4, 4),
        ],
        ..page(Design::Grid(ClearanceGrids {
            grids: vec![grid],
            left_out: 0,
            claims: true,
        }))
    }
}

fn levels() -> Vec<CaseLevel> {
    let about = |value: f64| Level {
        value,
        spread: 0.005 * value,
    };
    let level = |fault: usize, clearance_m: f64| CaseLevel {
        joints: FAULTS[fault].0.to_owned(),
        clearance_m,
        rms: about(230.0),
        peak: about(400.0 + 1e6 * clearance_m * fault as f64),
        high_rms: about(2.0 + 5e5 * clearance_m * fault as f64),
        high_share: 0.05 * fault as f64,
        chaotic: Some(fault > 1 && clearance_m > 1e-4),
    };
    let clear = (1..4).flat_map(|fault| [1e-4, 2e-4, 3e-4].map(|c| level(fault, c)));
    std::iter::once(level(0, 0.0)).chain(clear).collect()
}

/// Like a sweep of random cases, one of which failed.
pub fn random() -> DatasetPage {
    let mut uniform = Uniform(7);
    let mut draw = |n: usize, low: f64, high: f64| {
        (0..n)
            .map(|_| low + (high - low) * uniform.next())
            .collect::<Vec<_>>()
    };
    let histogram = |name: &str, unit: &str, values| Histogram {
        name: name.to_owned(),
        unit: unit.to_owned(),
        values,
    };
    let histograms = vec![
        histogram(
            "clearance of the big end",
            "m",
            draw(3000, 1e-5, 4e-4)
                .iter()
                .map(|c| c * c / 4e-4)
                .collect(),
        ),
        histogram("speed", "rpm", draw(3000, 350.0, 900.0)),
        histogram("discharge pressure", "Pa", draw(3000, 2.5e5, 6e5)),
    ];
    let clouds = (0..4).map(|fault| {
        let (clearances, scatter) = (draw(750, 1e-5, 4e-4), draw(750, 0.7, 1.4));
        let violence = [0.1, 1.0, 0.8, 1.6][fault];
        let rms = clearances
            .iter()
            .zip(&scatter)
            .map(|(c, s)| [*c, 220.0 + s * violence * 3e4 * c.sqrt()]);
        (FAULTS[fault].0.to_owned(), rms.collect())
    });
    let scatters = vec![Scatter {
        sensor: String::new(),
        x: ("largest clearance".to_owned(), "m".to_owned()),
        y: ("rms of the acceleration".to_owned(), "m/s²".to_owned()),
        log_y: true,
        classes: clouds.collect(),
    }];
    DatasetPage {
        name: "bearing-faults".to_owned(),
        about: "Random cases of the single-stage compressor with clearance in its joints."
            .to_owned(),
        faults: counts([750, 750, 749, 750]),
        warnings: Vec::new(),
        failed: vec![FailedCase {
            case_id: "1733".to_owned(),
            reason: "the step fell below 1e-14 s at t = 0.4321 s in the big end's contact"
                .to_owned(),
            command: "gen-dataset sweep.yaml --case 1733".to_owned(),
            died: false,
        }],
        ranges: vec![
            range("speed", "rpm", 350.1, 899.9, 2999),
            range("discharge pressure", "Pa", 2.5e5, 6e5, 2999),
        ],
        operation: operation(),
        ..page(Design::Random(RandomSweep {
            histograms,
            scatters,
        }))
    }
}

/// A healthy machine that resonates at 200 Hz, at nine speeds from 400 rpm to 800 rpm.
fn operation() -> Operation {
    let speeds = (0..9).map(|i| 400.0 + 50.0 * f64::from(i));
    let line = |order: f64, rpm: f64| {
        let detuned = order * rpm / 60.0 / 200.0 - 1.0;
        100.0 / (order * order) + 5.0 / (1.0 + 400.0 * detuned * detuned)
    };
    let spectra = speeds.clone().map(|rpm| {
        let orders = (1..=60).map(f64::from);
        let spectrum = Spectrum {
            at: orders.clone().collect(),
            amplitude_m_s2: orders.map(|order| line(order, rpm)).collect(),
            fundamental: 1.0,
        };
        (rpm * TAU / 60.0, spectrum)
    });
    let trend = Scatter {
        sensor: String::new(),
        x: ("speed".to_owned(), "rpm".to_owned()),
        y: ("rms".to_owned(), "m/s²".to_owned()),
        log_y: true,
        classes: vec![(
            "none".to_owned(),
            speeds.map(|rpm| [rpm, 1e-3 * rpm * rpm]).collect(),
        )],
    };
    Operation {
        trends: vec![trend],
        waterfalls: vec![Waterfall {
            fault: "none".to_owned(),
            sensor: String::new(),
            spectra: spectra.collect(),
        }],
    }
}

fn page(design: Design) -> DatasetPage {
    let feature = |name: &str, unit: &str| Feature {
        name: name.to_owned(),
        unit: unit.to_owned(),
    };
    DatasetPage {
        name: String::new(),
        about: String::new(),
        version: "0.1.0".to_owned(),
        seed: 42,
        sample_rate_hz: SAMPLE_RATE_HZ,
        samples_per_revolution: None,
        revolutions_per_window: 8,
        samples_per_window: (9600, 9600),
        channels: [
            "crank_angle_rad",
            "acceleration_m_s2",
            "frame_acceleration_m_s2",
            "pressure_pa",
        ]
        .map(str::to_owned)
        .into(),
        joints: ["main", "big_end", "small_end", "guide"]
            .map(str::to_owned)
            .into(),
        splits: ["train", "validation", "test"].map(str::to_owned).into(),
        faults: Vec::new(),
        ranges: Vec::new(),
        failed: Vec::new(),
        warnings: Vec::new(),
        examples: (0..4).map(example).collect(),
        no_examples: String::new(),
        design,
        operation: Operation::default(),
        cases: report::case_table::CaseTable::default(),
        ranking: vec![RankedFeature {
            name: "crosshead_acceleration.kurtosis".to_owned(),
            anova_f: 12.5,
            kruskal_wallis_h: 31.0,
            mutual_information: 0.8,
        }],
        by_class: Vec::new(),
        baseline: Some(Baseline {
            trained_on: 1200,
            tested_on: 400,
            accuracy: 0.92,
            balanced_accuracy: 0.895,
            classes: vec![ClassScore {
                class: "big_end".to_owned(),
                rows: 100,
                recall: 0.84,
                answers: [("big_end".to_owned(), 84), ("small_end".to_owned(), 16)].into(),
            }],
        }),
        features: vec![
            feature("rms", "m/s²"),
            feature("peak", "m/s²"),
            feature("crest", ""),
            feature("kurtosis", ""),
        ],
        feature_rows: (0..4)
            .map(|i| FeatureRow {
                fault: FAULTS[i].0.to_owned(),
                sensor: "crosshead_acceleration".to_owned(),
                windows: 40,
                values: [(233.0, 2.4), (1210.0, 310.0), (5.19, 0.8), (7.7, 2.12)]
                    .map(|(mean, spread)| (mean * (1.0 + 0.2 * i as f64), spread))
                    .into(),
            })
            .collect(),
        columns: [
            (
                "signals",
                "case_id",
                "string",
                "",
                "Number of the case in the sweep",
            ),
            (
                "signals",
                "fault",
                "string",
                "",
                "Joints whose clearance is above the machine's normal one",
            ),
            (
                "signals",
                "speed_rpm",
                "double",
                "rpm",
                "Mean speed of the crank",
            ),
            (
                "signals",
                "acceleration_m_s2",
                "list<float>",
                "m/s²",
                "Acceleration of the crosshead along the bore",
            ),
            (
                "features",
                "acceleration_rms_m_s2",
                "double",
                "m/s²",
                "Root mean square of the acceleration",
            ),
        ]
        .map(|c| {
            let [table, name, kind, unit, meaning] = [c.0, c.1, c.2, c.3, c.4].map(str::to_owned);
            Column {
                table,
                name,
                kind,
                unit,
                meaning,
            }
        })
        .into(),
    }
}

fn made(fault: usize, clearance_m: f64, revolutions: usize) -> Recording {
    let joints: Vec<(&'static str, f64)> = FAULTS[fault]
        .1
        .iter()
        .map(|&joint| (joint, clearance_m))
        .collect();
    recording(
        &joints,
        revolutions,
        1 + fault as u64 + (clearance_m * 1e6) as u64,
    )
}

fn response(made: &Recording, case: usize) -> Response {
    Response {
        case_id: format!("case-{case}"),
        file: "signals/train-00000-of-00001.parquet".to_owned(),
        crank_angle_rad: made.crank_angle_rad.clone(),
        acceleration_m_s2: made.acceleration_m_s2.clone(),
        velocity_m_s: made.velocity_m_s.clone(),
    }
}

fn example(fault: usize) -> ClassExample {
    let made = made(fault, 2e-4, 8);
    let (hertz, amplitude_m_s2) = spectrum(&made.acceleration_m_s2);
    let orders: Vec<f64> = hertz
        .iter()
        .map(|f| f * 60.0 / SPEED_RPM)
        .take_while(|order| *order <= 100.0)
        .collect();
    ClassExample {
        fault: FAULTS[fault].0.to_owned(),
        sensor: String::new(),
        operating_point: if fault == 0 {
            "500 rpm"
        } else {
            "clearance 0.2 mm, 500 rpm"
        }
        .to_owned(),
        response: response(&made, fault),
        order_spectrum: Spectrum {
            amplitude_m_s2: amplitude_m_s2[..orders.len()].to_vec(),
            at: orders,
            fundamental: 1.0,
        },
        spectrum: Spectrum {
            at: hertz,
            amplitude_m_s2,
            fundamental: 500.0 / 60.0,
        },
    }
}

fn counts(cases: [usize; 4]) -> Vec<FaultCount> {
    let split = |n: usize| vec![n - n / 5 - n / 10, n / 10, n / 5];
    FAULTS
        .iter()
        .zip(cases)
        .map(|((fault, _), n)| FaultCount {
            fault: (*fault).to_owned(),
            cases: split(n),
            windows: 4 * n,
        })
        .collect()
}

fn range(name: &str, unit: &str, low: f64, high: f64, distinct: usize) -> ParameterRange {
    ParameterRange {
        name: name.to_owned(),
        unit: unit.to_owned(),
        low,
        high,
        distinct,
    }
}
