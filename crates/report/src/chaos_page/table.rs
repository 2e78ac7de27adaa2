//! The table of all cases.

use study::chaos::cases::{CaseChaos, WindowChaos};
use study::chaos::regime::Regime;
use study::classes;

/// Standard errors below this share of the exponent are rounding as far as a reader is concerned.
const TINY: f64 = 1e-3;
const NOTHING: &str = "–";

/// A column: its head, its unit, and whether it holds numbers.
pub(super) struct Head {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) is_number: bool,
}

/// Heads and rows, without the columns that no case has anything in.
pub(super) struct Table {
    pub(super) heads: Vec<Head>,
    pub(super) rows: Vec<Vec<String>>,
}

impl Table {
    pub(super) fn new(cases: &[CaseChaos]) -> Self {
        let rows: Vec<[String; 9]> = cases.iter().map(cells).collect();
        let there = |column: usize| rows.iter().any(|row| row[column] != NOTHING);
        let kept: Vec<usize> = (0..9).filter(|&column| there(column)).collect();
        Self {
            heads: kept.iter().map(|&column| head(column)).collect(),
            rows: rows
                .iter()
                .map(|row| kept.iter().map(|&column| row[column].clone()).collect())
                .collect(),
        }
    }
}

fn head(column: usize) -> Head {
    let (name, unit, is_number) = [
        ("Case", "", false),
        ("Class", "", false),
        ("Clearance", "mm", true),
        ("Speed", "rpm", true),
        ("λ from the equations", "1/s", true),
        ("per revolution", "", true),
        ("Regime from the equations", "", false),
        ("λ from the signal", "1/s", false),
        ("Regime from the signal", "", false),
    ][column];
    Head {
        name,
        unit,
        is_number,
    }
}

fn cells(case: &CaseChaos) -> [String; 9] {
    let nothing = || NOTHING.to_owned();
    let exponent = |factor: f64| {
        let exponent = case.exponent.map(|both| both.map(|v| v * factor));
        exponent.map_or_else(nothing, |[value, error]| {
            if error < TINY * value.abs() {
                format!("{} ± {}", text::number(value, 5), text::number(error, 1))
            } else {
                text::mean_and_spread(value, error)
            }
        })
    };
    [
        case.case_id.clone(),
        classes::name(&case.joints),
        if case.clearance_m > 0.0 {
            text::number(case.clearance_m * 1e3, 4)
        } else {
            nothing()
        },
        text::number(case.speed_rpm, 4),
        exponent(1.0),
        exponent(60.0 / case.speed_rpm),
        case.regime.map_or_else(nothing, regime),
        each(case, signal),
        each(case, |window| {
            window.regime.map_or_else(String::new, regime)
        }),
    ]
}

fn regime(regime: Regime) -> String {
    match regime {
        Regime::Periodic(n @ 2..) => format!("periodic, {n} revolutions"),
        other => other.label().to_owned(),
    }
}

fn signal(window: &WindowChaos) -> String {
    let Some(three) = window.exponent else {
        return window.reason.clone();
    };
    let [value, low, high] = three.map(|v| text::number(v, 3));
    format!("{value}\u{a0}[{low},\u{a0}{high}]")
}

/// What is said of each window; once where all are alike.
fn each(case: &CaseChaos, said: impl Fn(&WindowChaos) -> String) -> String {
    let said: Vec<String> = case
        .windows
        .iter()
        .map(said)
        .filter(|said| !said.is_empty())
        .collect();
    match said.first() {
        None => NOTHING.to_owned(),
        Some(first) if said.iter().all(|other| other == first) => first.clone(),
        Some(_) => said.join("; "),
    }
}
