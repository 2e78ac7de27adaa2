//! The gas: indicator diagrams, where in the cycle the fit fails, and when the valves work.

use super::misfits::{AFTER, BEFORE};
use super::{CalibrationPage, words};
use crate::plate::Plate;
use calibrate::results::{Alternative, ByName, Gas};
use figure::{Axis, Colour, Figure, Mark, Panel, Series};

/// At most so many chambers have a picture, the first.
const MOST_CHAMBERS: usize = 16;
/// The recording.
const MEASURED: Colour = Colour::Ink;

/// The gas of a chamber in a run, and one revolution of its pressures.
pub(super) struct Chamber<'a> {
    run: &'a str,
    column: &'a str,
    pub(super) found: &'a Gas,
    points: &'a [Pressure],
}

/// The pressures at a crank angle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pressure {
    /// Crank angle.
    pub crank_angle_deg: f64,
    /// Piston to cover at the nominal clearance, and at the calibrated one, m.
    pub distance_m: [f64; 2],
    /// As recorded.
    pub measured_pa: f64,
    /// With the nominal and the calibrated parameters.
    pub simulated_pa: [f64; 2],
}

/// An event of a valve, as the table has it.
pub(super) struct Row {
    pub(super) what: String,
    pub(super) measured: String,
    pub(super) range: String,
    pub(super) calibrated: String,
    pub(super) apart: String,
}

/// The chambers whose gas was fitted.
pub(super) fn chambers(page: &CalibrationPage) -> Vec<Chamber<'_>> {
    let points = |run: &str, column: &str| {
        let points = page.pressures.get(run)?.get(column);
        points.map(Vec::as_slice)
    };
    let runs = page.results.gas.iter().flat_map(ByName::iter);
    let chambers =
        runs.flat_map(|(run, gas)| gas.iter().map(move |(column, found)| (run, column, found)));
    chambers
        .map(|(run, column, found)| Chamber {
            run,
            column,
            found,
            points: points(run, column).unwrap_or_default(),
        })
        .collect()
}

impl Chamber<'_> {
    pub(super) fn name(&self) -> String {
        format!("{}, {}", self.run, words::column(self.column).0)
    }

    /// What the fit cannot follow, in a sentence.
    pub(super) fn verdict(&self) -> String {
        let kilo = |pa: f64| text::quantity(pa / 1e3, "kPa");
        let phases = self.found.phases.iter();
        let worst = phases.max_by(|a, b| a.share.total_cmp(&b.share));
        let place = worst.map_or(String::new(), |phase| {
            let [from, to] = phase.crank_angle_deg.map(|a| text::decimal(a, 0));
            let share = text::decimal(100.0 * phase.share, 0);
            format!(
                " {share}\u{a0}% of the squared difference is in the {} ({from}° to {to}°), where the difference is {}.",
                phase.phase,
                kilo(phase.rms_pa)
            )
        });
        format!(
            "The simulated pressure differs from the recorded one by {} (root mean square over the revolution), and by {} with \
             the nominal parameters.{place}",
            kilo(self.found.rms_pa.calibrated),
            kilo(self.found.rms_pa.nominal)
        )
    }

    /// What the curve leaves open about clearance and exponents; empty where that is not known.
    pub(super) fn open(&self) -> String {
        let Some(diagram) = &self.found.measured else {
            return String::new();
        };
        let [first, last] = diagram.alternatives;
        let share = |value: f64| format!("{}\u{a0}%", text::decimal(100.0 * value, 1));
        let exponents = |other: Alternative| {
            let both = [other.compression_exponent, other.expansion_exponent];
            both.map(|exponent| text::decimal(exponent, 2))
                .join(" and ")
        };
        format!(
            "Clearance and exponents are strongly correlated. A clearance of {} of the stroke goes with exponents of {} \
             (compression, expansion), and one of {} with {}. The lines are then straight to {} and {} of the pressure.",
            share(first.clearance_share),
            exponents(first),
            share(last.clearance_share),
            exponents(last),
            share(first.scatter),
            share(last.scatter)
        )
    }

    pub(super) fn rows(&self) -> Vec<Row> {
        let (Some(measured), Some(calibrated)) = (&self.found.measured, &self.found.calibrated)
        else {
            return Vec::new();
        };
        let degrees = |angle: f64| format!("{}°", text::decimal(angle, 1));
        let [measured, calibrated] = [measured, calibrated].map(|d| d.valve_events.each());
        let pairs = measured.into_iter().zip(calibrated);
        pairs
            .map(|((what, measured), (_, calibrated))| {
                let (angle, fitted) = (measured.crank_angle_deg, calibrated.crank_angle_deg);
                // The shorter way round.
                let apart = (fitted - angle + 180.0).rem_euclid(360.0) - 180.0;
                Row {
                    what: text::words(what),
                    measured: degrees(angle),
                    range: format!("{} to {}", degrees(measured.low), degrees(measured.high)),
                    calibrated: degrees(fitted),
                    apart: degrees(apart),
                }
            })
            .collect()
    }
}

/// A picture per chamber.
pub(super) fn plates(chambers: &[Chamber]) -> Vec<Plate> {
    chambers.iter().take(MOST_CHAMBERS).map(plate).collect()
}

fn plate(chamber: &Chamber) -> Plate {
    Plate {
        heading: format!("Indicator diagram: {}", chamber.name()),
        caption: "Left: pressure over the distance from piston to cover, which is the volume divided by the piston's area. \
                  Middle: the same on logarithmic axes. Enclosed gas follows a straight line there, and the slope is its \
                  exponent; the fitted stretches are bold. Right: calibrated less measured pressure over the crank angle."
            .to_owned(),
        figure: Figure {
            rows: vec![vec![
                over_distance(chamber, false),
                over_distance(chamber, true),
                difference(chamber),
            ]],
            row_height: 260.0,
            ..Figure::default()
        },
        ..Plate::default()
    }
}

/// Measured and nominal pressure stand at the nominal clearance, the calibrated one at its own.
fn over_distance(chamber: &Chamber, logarithmic: bool) -> Panel {
    let points = chamber.points;
    let curve = |of: &dyn Fn(&Pressure) -> [f64; 2]| -> Vec<[f64; 2]> {
        let at = points.iter().map(|p| {
            let [distance, pressure] = of(p);
            [1e3 * distance, 1e-6 * pressure]
        });
        // The end of the revolution is its beginning.
        let first: Vec<[f64; 2]> = at.clone().take(1).collect();
        at.chain(first).collect()
    };
    let mut series = vec![
        Series::new(
            "before",
            BEFORE,
            Mark::Line,
            curve(&|p| [p.distance_m[0], p.simulated_pa[0]]),
        ),
        Series::new(
            "after calibration",
            AFTER,
            Mark::Line,
            curve(&|p| [p.distance_m[1], p.simulated_pa[1]]),
        ),
        Series::new(
            "measured",
            MEASURED,
            Mark::Line,
            curve(&|p| [p.distance_m[0], p.measured_pa]),
        ),
    ];
    if logarithmic && let Some(diagram) = &chamber.found.measured {
        for polytrope in [diagram.compression, diagram.expansion] {
            let [from, to] = polytrope.crank_angle_deg;
            let length = (to - from).rem_euclid(360.0);
            let inside = |p: &&Pressure| (p.crank_angle_deg - from).rem_euclid(360.0) <= length;
            let line = points.iter().filter(inside);
            let line = line.map(|p| [1e3 * p.distance_m[0], 1e-6 * p.measured_pa]);
            series.push(Series::new("enclosed gas", MEASURED, Mark::BoldLine, line));
        }
    }
    let axis = |label: &str| match logarithmic {
        true => Axis::log(label),
        false => Axis::linear(label),
    };
    Panel {
        title: match logarithmic {
            true => "Logarithmic",
            false => "Pressure over volume",
        }
        .to_owned(),
        x: axis("piston to cover (mm)"),
        y: axis("pressure (MPa)"),
        series,
        ..Panel::default()
    }
}

fn difference(chamber: &Chamber) -> Panel {
    let points = chamber.points.iter();
    let at = points.map(|p| {
        [
            p.crank_angle_deg,
            1e-3 * (p.simulated_pa[1] - p.measured_pa),
        ]
    });
    let mut at: Vec<[f64; 2]> = at.collect();
    at.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Panel {
        title: "Calibrated less measured".to_owned(),
        x: Axis::crank_angle(),
        y: Axis::linear("(kPa)"),
        series: vec![Series::new("after calibration", AFTER, Mark::Line, at)],
        ..Panel::default()
    }
}
