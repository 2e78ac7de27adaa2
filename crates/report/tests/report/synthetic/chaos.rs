//! A made-up page about chaos: the logistic map in place of the machine.

use super::{Uniform, recording, spectrum};
use report::chaos_page::ChaosPage;
use std::f64::consts::TAU;
use study::chaos::bifurcations::{Bifurcation, Recorded, Section};
use study::chaos::cases::{CaseChaos, WindowChaos};
use study::chaos::motions::{Motion, MotionRow, Orbit};
use study::chaos::regime::Regime;
use study::chaos::spectra::{ClassSpectra, Quartiles};

const SETS: [(&str, &[&str]); 3] = [
    ("big_end", &["big_end"]),
    ("small_end", &["small_end"]),
    ("big_end+small_end", &["big_end", "small_end"]),
];
const CLEARANCES_MM: [f64; 5] = [0.05, 0.1, 0.2, 0.3, 0.5];
const SPEEDS_RPM: [f64; 2] = [350.0, 500.0];

/// A page with every section.
pub fn page() -> ChaosPage {
    ChaosPage {
        name: "chaos-map".to_owned(),
        version: "0.1.0".to_owned(),
        seed: 3,
        joints: ["main", "big_end", "small_end", "guide"]
            .map(str::to_owned)
            .into(),
        claims: true,
        motions: SETS.iter().map(row).collect(),
        shown: "All cases of the first operating point, 500 rpm.".to_owned(),
        bifurcations: vec![bifurcation()],
        cases: cases(),
        spectra: SETS.iter().map(|(set, _)| spectra(set)).collect(),
        most_windows: 100,
    }
}

fn row((name, joints): &(&str, &[&'static str])) -> MotionRow {
    let motion = |millimetres: &f64| {
        let clear: Vec<(&str, f64)> = joints.iter().map(|&j| (j, millimetres * 1e-3)).collect();
        let made = recording(&clear, 6, (millimetres * 1e3) as u64);
        let mut uniform = Uniform(5);
        let mut near = |n: usize, middle: [f64; 2], spread: [f64; 2]| -> Vec<[f64; 2]> {
            let mut one = |i: usize| middle[i] + spread[i] * millimetres * (uniform.next() - 0.5);
            (0..n).map(|_| [one(0), one(1)]).collect()
        };
        let strobe = near(60, [0.0, -400.0], [0.05, 600.0]);
        let orbits = made.joints.iter().map(|joint| Orbit {
            name: joint.name.to_owned(),
            clearance_m: joint.clearance_m,
            x_m: joint.x_m.clone(),
            y_m: joint.y_m.clone(),
            impacts: near(150, [1.8, 0.1], [4.0, 0.2]),
        });
        Some(Motion {
            title: format!("{millimetres} mm"),
            case_id: "case-000001".to_owned(),
            joints: orbits.collect(),
            crank_angle_rad: made.crank_angle_rad.iter().map(|a| a % TAU).collect(),
            velocity_m_s: made.velocity_m_s,
            acceleration_m_s2: made.acceleration_m_s2,
            strobe,
        })
    };
    MotionRow {
        heading: name.replace('_', " "),
        motions: CLEARANCES_MM.iter().map(motion).collect(),
    }
}

/// x → r x (1 − x), with other transients up and down.
fn bifurcation() -> Bifurcation {
    let branch = |start: f64| -> Vec<[f64; 2]> {
        let values = (0..160).map(|i| 2.8 + 0.0075 * f64::from(i));
        let of = |r: f64| {
            let mut x = start;
            let all = (0..140).map(move |_| {
                x = r * x * (1.0 - x);
                [(r - 2.8) * 5e-4, 1000.0 * x]
            });
            all.skip(60)
        };
        values.flat_map(of).collect()
    };
    Bifurcation {
        sections: vec![Section {
            value: 0.2e-3,
            up: vec![[0.01, -380.0], [0.02, -350.0]],
            down: vec![[0.01, -380.0]],
        }],
        name: "big-end".to_owned(),
        parameter: "clearance of the big end".to_owned(),
        unit: "m".to_owned(),
        quantities: vec![Recorded {
            name: "peak acceleration".to_owned(),
            unit: "m/s²".to_owned(),
            up: branch(0.2),
            down: branch(0.7),
        }],
        reasons: Vec::new(),
    }
}

fn cases() -> Vec<CaseChaos> {
    let mut uniform = Uniform(9);
    let mut all = Vec::new();
    for (set, joints) in SETS {
        for (speed_rpm, millimetres) in SPEEDS_RPM
            .iter()
            .flat_map(|s| CLEARANCES_MM.map(|c| (*s, c)))
        {
            let truth = -12.0 + 50.0 * millimetres * joints.len() as f64 + uniform.next();
            let chaotic = truth > 0.0;
            let signal = truth.max(0.2) * (0.8 + 0.4 * uniform.next());
            let refused = uniform.next() < 0.2;
            let regime = if chaotic {
                Regime::Chaotic
            } else {
                Regime::Periodic(1 + u32::from(truth > -3.0))
            };
            all.push(CaseChaos {
                case_id: format!("case-{:06}", all.len()),
                joints: set.to_owned(),
                clearance_m: millimetres * 1e-3,
                speed_rpm,
                operating_point: speed_rpm as usize,
                exponent: Some([truth, 0.6]),
                regime: Some(regime),
                windows: vec![WindowChaos {
                    exponent: (!refused).then_some([signal, signal - 1.0, signal + 1.5]),
                    reason: if refused {
                        "no scaling region".to_owned()
                    } else {
                        String::new()
                    },
                    regime: Some(if refused { Regime::Undecided } else { regime }),
                }],
            });
        }
    }
    all
}

fn spectra(set: &str) -> ClassSpectra {
    let joints: Vec<(&str, f64)> = SETS
        .iter()
        .find(|(name, _)| *name == set)
        .map(|(_, joints)| joints.iter().map(|&j| (j, 2e-4)).collect())
        .unwrap_or_default();
    let curves: Vec<(Vec<f64>, Vec<f64>)> = (1..8)
        .map(|seed| spectrum(&recording(&joints, 4, seed).acceleration_m_s2))
        .collect();
    let at = curves[0].0.clone();
    let amplitudes: Vec<Vec<f64>> = curves.into_iter().map(|(_, amplitude)| amplitude).collect();
    let orders: Vec<f64> = at.iter().take(80).map(|f| f / 10.0).collect();
    ClassSpectra {
        class: set.to_owned(),
        windows: 7,
        envelope: Quartiles::from_curves(&orders, &amplitudes),
        spectrum: Quartiles::from_curves(&at, &amplitudes),
    }
}
