//! Exponents against clearance, and from the signal against from the equations.

use super::ChaosPage;
use super::levels::Levels;
use crate::plate::Plate;
use figure::{Axis, Colour, Figure, Mark, Panel, Series, Share};
use study::chaos::agreement::{self, Agreement};
use study::chaos::cases::CaseChaos;
use study::classes;
use study::statistics::HALF;

/// With more speeds than this, all share a panel.
pub(super) const MOST_SPEEDS: usize = 3;
/// At most this many sets of joints.
const MOST_SETS: usize = 8;
/// A panel draws at most so many cases, and the scatter so many windows: evenly over the sweep.
const MOST_DRAWN: usize = 1_500;
const EQUATIONS: Colour = Colour::Class(0);
const SIGNAL: Colour = Colour::Class(1);

/// Against clearance, a panel per set of joints and speed.
pub(super) fn against_clearance(page: &ChaosPage) -> Vec<Plate> {
    let known = |case: &&CaseChaos| {
        case.exponent.is_some() || case.windows.iter().any(|window| window.exponent.is_some())
    };
    let cases: Vec<&CaseChaos> = page.cases.iter().filter(known).collect();
    if cases.is_empty() {
        return Vec::new();
    }
    let speeds = Levels::from_values(cases.iter().map(|case| case.speed_rpm));
    let mut sets: Vec<&str> = Vec::new();
    for case in &cases {
        if !sets.contains(&case.joints.as_str()) {
            sets.push(&case.joints);
        }
    }
    sets.truncate(MOST_SETS);
    let apart = speeds.width == 0.0 && (2..=MOST_SPEEDS).contains(&speeds.count());
    let names = speeds.names(1.0);
    let rows: Vec<Vec<Panel>> = if apart {
        let of_set = |set: &&str| {
            let panels = names.iter().enumerate().map(|(i, name)| {
                let own = cases
                    .iter()
                    .filter(|case| case.joints == **set && speeds.index(case.speed_rpm) == Some(i));
                panel(&format!("{}, {name}\u{a0}rpm", set_words(set)), own)
            });
            panels.collect()
        };
        sets.iter().map(of_set).collect()
    } else {
        let panels = sets.iter().map(|set| {
            let own = cases.iter().filter(|case| case.joints == **set);
            panel(&set_words(set), own)
        });
        figure::in_rows(panels.collect(), 3)
    };
    vec![Plate {
        heading: "Exponent against clearance".to_owned(),
        caption: format!(
            "Largest Lyapunov exponent of each case: from the equations (discs, bars of ±{HALF} standard errors) and from the \
             measured acceleration of each window (rings, 95 % intervals), over the largest clearance. Above the grey line \
             neighbouring motions diverge and the motion is chaotic; below it they converge. The signal of a periodic motion \
             does not show how fast neighbours converge, so rings do not follow discs below the line.{}",
            speed_words(apart, &speeds)
        ),
        figure: Figure {
            rows,
            row_height: 180.0,
            share_x: Share::All,
            share_y: Share::All,
            ..Figure::default()
        },
        ..Plate::default()
    }]
}

/// At most [`MOST_DRAWN`] of them, spread evenly.
fn evenly<T: Copy>(all: &[T]) -> impl Iterator<Item = T> {
    all.iter()
        .copied()
        .step_by(all.len().div_ceil(MOST_DRAWN).max(1))
}

fn speed_words(apart: bool, speeds: &Levels) -> &'static str {
    if apart || speeds.count() < 2 {
        ""
    } else {
        " All speeds are in one panel."
    }
}

fn set_words(joints: &str) -> String {
    text::capitalised(&classes::name(joints))
}

fn panel<'a>(title: &str, cases: impl Iterator<Item = &'a &'a CaseChaos>) -> Panel {
    const MILLIMETRES: f64 = 1e3;
    let (mut truths, mut true_bars) = (Vec::new(), Vec::new());
    let (mut signals, mut signal_bars) = (Vec::new(), Vec::new());
    let cases: Vec<&&CaseChaos> = cases.collect();
    for case in evenly(&cases) {
        let x = case.clearance_m * MILLIMETRES;
        if let Some([value, error]) = case.exponent {
            truths.push([x, value]);
            true_bars.push([x, value - HALF * error, value + HALF * error]);
        }
        for [value, low, high] in case.windows.iter().filter_map(|window| window.exponent) {
            signals.push([x, value]);
            signal_bars.push([x, low, high]);
        }
    }
    let zero = [[-1e6, 0.0], [1e6, 0.0]];
    let ends: Vec<f64> = truths
        .iter()
        .chain(&signals)
        .map(|point| point[0])
        .collect();
    let highest = ends.iter().copied().fold(0.0, f64::max);
    Panel {
        title: title.to_owned(),
        x: Axis {
            range: (highest > 0.0).then_some((0.0, 1.08 * highest)),
            ..Axis::linear("clearance (mm)")
        },
        y: Axis::linear("exponent (1/s)"),
        series: vec![
            Series::new("", Colour::Ink, Mark::Line, zero),
            Series::intervals(SIGNAL, signal_bars),
            Series::new(
                named(&signals, "from the signal"),
                SIGNAL,
                Mark::Rings,
                signals,
            ),
            Series::intervals(EQUATIONS, true_bars),
            Series::new(
                named(&truths, "from the equations"),
                EQUATIONS,
                Mark::Points,
                truths,
            ),
        ],
        ..Panel::default()
    }
}

/// The name, for the legend, of a series that has points.
fn named(points: &[[f64; 2]], name: &'static str) -> &'static str {
    if points.is_empty() { "" } else { name }
}

/// The scatter of one over the other, where any window has both.
pub(super) fn scatter(page: &ChaosPage) -> Vec<Plate> {
    let pairs = agreement::pairs(&page.cases);
    let Some(agreement) = Agreement::new(&page.cases).filter(|_| !pairs.is_empty()) else {
        return Vec::new();
    };
    let both = pairs
        .iter()
        .flat_map(|(truth, signal)| [truth[0], signal[0]]);
    let (low, high) = both.fold((0.0_f64, 0.0_f64), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    let across = pairs.iter().flat_map(|([value, error], signal)| {
        let y = signal[0];
        [
            [value - HALF * error, y],
            [value + HALF * error, y],
            [f64::NAN; 2],
        ]
    });
    let upright = pairs
        .iter()
        .map(|(truth, [_, low, high])| [truth[0], *low, *high]);
    let panel = Panel {
        x: Axis::linear("exponent from the equations (1/s)"),
        y: Axis::linear("exponent from the signal (1/s)"),
        series: vec![
            Series::new(
                "both equal",
                Colour::Ink,
                Mark::Line,
                [[low, low], [high, high]],
            ),
            Series::intervals(SIGNAL, upright),
            Series::new("", EQUATIONS, Mark::Line, across),
            Series::new(
                "a window",
                SIGNAL,
                Mark::Rings,
                pairs.iter().map(|(truth, signal)| [truth[0], signal[0]]),
            ),
        ],
        ..Panel::default()
    };
    vec![Plate {
        heading: "Exponent from the signal against from the equations".to_owned(),
        caption: scatter_words(&agreement),
        figure: Figure {
            rows: vec![vec![panel]],
            row_height: 340.0,
            width: 760.0,
            ..Figure::default()
        },
        ..Plate::default()
    }]
}

fn scatter_words(agreement: &Agreement) -> String {
    let share = |n: usize, of: usize| {
        if of == 0 {
            return "none".to_owned();
        }
        let percent = text::number(100.0 * n as f64 / of as f64, 3);
        format!("{n} of {of} ({percent}\u{a0}%)")
    };
    let correlation = agreement
        .rank_correlation
        .map_or_else(|| "not defined".to_owned(), |rho| text::decimal(rho, 2));
    let reasons: Vec<String> = agreement
        .reasons
        .iter()
        .map(|(reason, n)| format!("{reason}: {n}"))
        .collect();
    let reasons = if reasons.is_empty() {
        String::new()
    } else {
        format!(" ({})", reasons.join("; "))
    };
    format!(
        "A ring per window: upright the 95 % interval of the exponent from the signal, across ±{HALF} standard errors of the \
         exponent from the equations. Spearman's rank correlation: {correlation}. Intervals that hold the exponent from the \
         equations: {}; where that is positive: {}. The signal gives no exponent for {} of {}{reasons}.",
        share(agreement.covered, agreement.compared),
        share(agreement.positive_covered, agreement.positive),
        agreement.abstained,
        text::counted(agreement.compared + agreement.abstained, "window"),
    )
}
