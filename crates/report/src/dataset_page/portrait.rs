//! Velocity-acceleration portraits.

use crate::revolutions::last_turns;
use figure::{Axis, Colour, Mark, Panel, Series};
use study::recording::Response;

/// Most revolutions of a portrait: with more, the lines of a motion that does not repeat overlap.
pub(super) const PORTRAIT_REVOLUTIONS: usize = 10;

/// Acceleration against velocity over the last revolutions.
pub(super) fn portrait(title: &str, response: &Response, colour: Colour) -> Panel {
    let points = response
        .velocity_m_s
        .iter()
        .zip(&response.acceleration_m_s2)
        .skip(last_turns(&response.crank_angle_rad, PORTRAIT_REVOLUTIONS))
        .map(|(&v, &a)| [v, a]);
    Panel {
        title: title.to_owned(),
        x: Axis::linear("velocity (m/s)"),
        y: Axis::linear("acceleration (m/s²)"),
        series: vec![Series::new("", colour, Mark::Line, points)],
        note: if response.velocity_m_s.is_empty() {
            "no velocity in the data".to_owned()
        } else {
            String::new()
        },
        ..Panel::default()
    }
}
