//! Indicator diagrams: what the gas does, and where the simulation misses it.

use super::misfits::{AFTER, BEFORE};
use super::{CalibrationPage, Indicator, words};
use crate::figure::{Axis, Colour, Figure, Mark, Panel, Series, in_rows};
use crate::plate::Plate;
use crate::text;

/// At most so many diagrams are drawn, the first.
const MOST: usize = 12;

/// All diagrams in one figure; none where no pressure was recorded.
pub(super) fn plate(page: &CalibrationPage) -> Option<Plate> {
    let shown = &page.indicators[..page.indicators.len().min(MOST)];
    if shown.is_empty() {
        return None;
    }
    let left_out = page.indicators.len() - shown.len();
    let more = match left_out {
        0 => String::new(),
        n => format!(" {} more stand in indicator.parquet.", text::count(n)),
    };
    Some(Plate {
        heading: "Pressure over the way of the piston".to_owned(),
        caption: format!(
            "From the cover outwards. The area within the line is the work of the gas on one revolution. A bulge above the discharge \
             pressure or below the suction pressure is the loss in the valves.{more}"
        ),
        svg: Figure {
            rows: in_rows(shown.iter().map(panel).collect(), 2),
            row_height: 260.0,
            ..Figure::default()
        }
        .svg(),
    })
}

/// How far each simulated pressure is from the recorded one, and where.
pub(super) fn sentences(page: &CalibrationPage) -> Vec<String> {
    let say = |indicator: &Indicator| {
        let pressure = |value: f64| {
            let (scale, unit) = text::readable_unit(value, "Pa");
            text::quantity(value * scale, unit)
        };
        let greatest = indicator.shares.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let place = greatest.map_or_else(String::new, |(phase, share)| {
            let percent = text::number(100.0 * share, 2);
            format!(
                "; {percent}\u{a0}% of what is left stands in the {}",
                text::words(phase)
            )
        });
        format!(
            "{}, {}: {} RMS from the recording (before: {}){place}.",
            indicator.run,
            words::column(&indicator.column).0,
            pressure(indicator.rms_pa.after),
            pressure(indicator.rms_pa.before),
        )
    };
    page.indicators.iter().take(MOST).map(say).collect()
}

fn panel(indicator: &Indicator) -> Panel {
    let largest = indicator.measured.iter().map(|p| p[1]).fold(0.0, f64::max);
    let (scale, unit) = text::readable_unit(largest, "Pa");
    let line = |label: &str, colour: Colour, points: &[[f64; 2]]| {
        let points = points.iter().map(|[x, p]| [1e3 * x, scale * p]);
        Series::new(label, colour, Mark::Line, points)
    };
    let column = words::column(&indicator.column).0;
    Panel {
        title: format!("{}, {column}", indicator.run),
        x: Axis::linear("piston to cover (mm)"),
        y: Axis::linear(text::with_unit("pressure", unit)),
        series: vec![
            line("before", BEFORE, &indicator.before),
            line("measured", Colour::Ink, &indicator.measured),
            line("after calibration", AFTER, &indicator.after),
        ],
        ..Panel::default()
    }
}
