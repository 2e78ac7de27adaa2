//! How far each run is from its simulation, before and after.

use super::{CalibrationPage, Misfit, Run};
use crate::plate::Plate;
use figure::{Axis, Colour, Figure, Mark, Panel, Series};

/// The simulation with nominal parameters, in every figure.
pub(crate) const BEFORE: Colour = Colour::Class(1);
/// The simulation with the calibrated ones.
pub(crate) const AFTER: Colour = Colour::Class(0);
/// Height of a row with a name, pixels.
pub(crate) const ROW: f64 = 26.0;
/// At most so many runs are drawn, the first.
const MOST_RUNS: usize = 60;

/// Each run's misfit; none where there is no run.
pub(super) fn plate(page: &CalibrationPage) -> Option<Plate> {
    let runs = &page.runs[..page.runs.len().min(MOST_RUNS)];
    if runs.is_empty() {
        return None;
    }
    let top = runs.len() as f64 - 1.0;
    let at = |of: fn(&Misfit) -> f64| {
        let points = runs.iter().enumerate();
        points
            .map(|(i, run)| [of(&run.misfit), top - i as f64])
            .collect::<Vec<_>>()
    };
    let steps = runs.iter().enumerate().flat_map(|(i, run)| {
        let y = top - i as f64;
        [[run.misfit.before, y], [run.misfit.after, y], [f64::NAN; 2]]
    });
    let name = |run: &Run| match run.held_out {
        true => format!("{} (held out)", run.id),
        false => run.id.clone(),
    };
    let panel = Panel {
        x: Axis::log("misfit (times the noise)"),
        y: Axis::named("", runs.iter().rev().map(name).collect()),
        series: vec![
            Series::new(
                "noise floor",
                Colour::Ink,
                Mark::Line,
                [[1.0, -1.0], [1.0, top + 1.0]],
            ),
            Series::new("", Colour::Ink, Mark::FaintLine, steps),
            Series::new("before", BEFORE, Mark::Rings, at(|misfit| misfit.before)),
            Series::new(
                "after calibration",
                AFTER,
                Mark::Discs,
                at(|misfit| misfit.after),
            ),
        ],
        ..Panel::default()
    };
    Some(Plate {
        heading: "Misfit of every run".to_owned(),
        caption: "Root mean square difference between the amplitudes of the orders in simulation and recording, divided by the \
                  standard deviation of their noise. At 1 only noise is left. Held-out runs are predicted, not fitted."
            .to_owned(),
        figure: Figure {
            rows: vec![vec![panel]],
            row_height: ROW * (runs.len() as f64 + 0.5),
            ..Figure::default()
        },
        ..Plate::default()
    })
}
