//! A signal over the crank angle, revolution by revolution.

use crate::revolutions::Revolutions;
use figure::{Colour, Mark, Series};

/// At most this many revolutions are drawn behind their mean: the last ones.
const REVOLUTIONS: usize = 20;

/// The last revolutions lightly and their mean on top; a single revolution as a line.
pub(crate) fn over_crank_angle(
    crank_angle_rad: &[f64],
    signal: &[f64],
    colour: Colour,
    name: &str,
) -> Vec<Series> {
    let revolutions = Revolutions::new(crank_angle_rad, signal);
    let Some(mean) = revolutions.mean() else {
        return vec![Series::new(name, colour, Mark::Line, revolutions.longest())];
    };
    let skipped = revolutions.curves.len().saturating_sub(REVOLUTIONS);
    let each = revolutions.curves.into_iter().skip(skipped);
    let mut series: Vec<Series> = each
        .map(|curve| Series::new("", colour, Mark::FaintLine, curve))
        .collect();
    series.push(Series::new(name, colour, Mark::BoldLine, mean));
    series
}
